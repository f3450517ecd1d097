from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
env.Replace(AR="gcc-ar", AS="gcc", CC="gcc", CXX="g++", LINK="gcc", RANLIB="gcc-ranlib", PROGNAME="program")
Default([env.BuildProgram()])

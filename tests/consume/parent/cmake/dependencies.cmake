# A module of the parent, with a name that the library might have chosen.
set(PARENT_MODULE_dependencies TRUE)

/*
 * The library's version. CMake, the package files and the program read it here.
 */
#ifndef IQFOC_VERSION_H
#define IQFOC_VERSION_H

#define IQFOC_VERSION_MAJOR  0
#define IQFOC_VERSION_MINOR  1
#define IQFOC_VERSION_PATCH  0
#define IQFOC_VERSION_STRING "0.1.0"

#endif

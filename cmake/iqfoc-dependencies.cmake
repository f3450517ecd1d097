# The libraries of the host program, each as a target `dep::NAME` (with a .pc file also as PkgConfig::NAME). All except zlib are headers
# only, so they compile for every processor. One message names all missing Debian packages.
find_package(PkgConfig REQUIRED)

set(missing_packages "")

# dep::<name> from pkg-config's <module>, out of Debian's <package>.
macro(iqfoc_dependency name module package)
    string(TOUPPER ${name} prefix)
    pkg_check_modules(${prefix} QUIET IMPORTED_TARGET GLOBAL ${module})
    if(${prefix}_FOUND)
        add_library(dep::${name} ALIAS PkgConfig::${prefix})
    else()
        list(APPEND missing_packages ${package})
    endif()
endmacro()

# dep::<name> from a header and libraries, for a package without a .pc file.
function(iqfoc_dependency_by_file name package header)
    find_path(${name}_INCLUDE_DIR ${header})
    set(libraries "")
    foreach(library IN LISTS ARGN)
        find_library(${name}_${library}_LIBRARY ${library})
        list(APPEND libraries ${${name}_${library}_LIBRARY})
    endforeach()
    if(NOT ${name}_INCLUDE_DIR OR "${libraries}" MATCHES "NOTFOUND")
        set(missing_packages ${missing_packages} ${package} PARENT_SCOPE)
        return()
    endif()
    add_library(dep_${name} INTERFACE)
    target_include_directories(dep_${name} SYSTEM INTERFACE ${${name}_INCLUDE_DIR})
    target_link_libraries(dep_${name} INTERFACE ${libraries})
    add_library(dep::${name} ALIAS dep_${name})
endfunction()

# dep::<name>, a library of headers alone, out of Debian's <package>. They fit every processor, but the folder that they are
# installed in holds this machine's C library as well: the compiler is shown a link to the one folder of <header>.
function(iqfoc_header_library name package header)
    find_path(${name}_INCLUDE_DIR ${header} PATH_SUFFIXES eigen3 NO_CMAKE_FIND_ROOT_PATH)
    if(NOT ${name}_INCLUDE_DIR)
        set(missing_packages ${missing_packages} ${package} PARENT_SCOPE)
        return()
    endif()
    string(REGEX REPLACE "/.*" "" folder ${header})
    file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/headers)
    file(CREATE_LINK ${${name}_INCLUDE_DIR}/${folder} ${PROJECT_BINARY_DIR}/headers/${folder} SYMBOLIC)
    add_library(dep_${name} INTERFACE)
    target_include_directories(dep_${name} SYSTEM INTERFACE ${PROJECT_BINARY_DIR}/headers)
    add_library(dep::${name} ALIAS dep_${name})
endfunction()

iqfoc_header_library(eigen libeigen3-dev Eigen/Cholesky)
iqfoc_header_library(kissfft libkissfft-dev kissfft/kissfft.hh)
iqfoc_header_library(json nlohmann-json3-dev nlohmann/json.hpp)
iqfoc_header_library(tomlplusplus libtomlplusplus-dev toml++/toml.h)
# What it has for std::filesystem stays out: not every C++ library has that.
if(TARGET dep_json)
    target_compile_definitions(dep_json INTERFACE JSON_HAS_FILESYSTEM=0 JSON_HAS_EXPERIMENTAL_FILESYSTEM=0)
endif()
option(IQFOC_ZLIB "Read packed recordings (.csv.gz) and export FMUs; without it both are refused" ON)
set(ZLIB_SOURCE_DIR "$ENV{ZLIB_SOURCE_DIR}" CACHE PATH "zlib's sources, for another processor or a static program")
if(IQFOC_ZLIB AND ZLIB_SOURCE_DIR AND (CMAKE_CROSSCOMPILING OR IQFOC_STATIC))
    include(${CMAKE_CURRENT_LIST_DIR}/iqfoc-zlib.cmake)
elseif(IQFOC_ZLIB)
    iqfoc_dependency(zlib zlib zlib1g-dev)
endif()

# The independent integrator is a witness in tests, no part of the program.
if(BUILD_TESTING AND IQFOC_TESTS STREQUAL all)
    iqfoc_dependency_by_file(cvode libsundials-dev cvode/cvode.h
        sundials_cvode sundials_nvecserial sundials_sunmatrixdense sundials_sunlinsoldense)
endif()

if(missing_packages)
    list(JOIN missing_packages " " missing_packages)
    message(FATAL_ERROR "Libraries are missing. On Debian: apt-get install ${missing_packages}\n"
                        "(`./dev build` and `./dev test` install what they need.)")
endif()

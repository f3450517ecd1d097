# The libraries that the host program stands on, each as one target `dep::NAME` (and, where it brings a .pc file, as
# PkgConfig::NAME). All that is missing is named at once, by its Debian package.
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

iqfoc_dependency(lapacke lapacke liblapacke-dev)
iqfoc_dependency(fftw3 fftw3 libfftw3-dev)
iqfoc_dependency(jansson jansson libjansson-dev)
iqfoc_dependency(zlib zlib zlib1g-dev)
iqfoc_dependency(tomlplusplus tomlplusplus libtomlplusplus-dev)
iqfoc_dependency_by_file(csv libcsv-dev csv.h csv)

# The independent integrator is a witness in tests, no part of the program.
if(BUILD_TESTING)
    iqfoc_dependency_by_file(cvode libsundials-dev cvode/cvode.h
        sundials_cvode sundials_nvecserial sundials_sunmatrixdense sundials_sunlinsoldense)
endif()

if(missing_packages)
    list(JOIN missing_packages " " missing_packages)
    message(FATAL_ERROR "Libraries are missing. On Debian: apt-get install ${missing_packages}\n"
                        "(`./dev build` and `./dev test` install what they need.)")
endif()

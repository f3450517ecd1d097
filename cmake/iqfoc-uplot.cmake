# uPlot (npm, MIT), which draws the report pages' curves. Sets UPLOT_DIR to the folder of its files as `npm pack uplot` has
# them. packages/uplot.sha256 pins the files, so that a page is the same on every machine.
include(${CMAKE_CURRENT_LIST_DIR}/iqfoc-pins.cmake)
# (What an earlier configuration of the Python package put there, below, is put there again.)
if(UPLOT_DIR STREQUAL "${PROJECT_BINARY_DIR}/uplot")
    unset(UPLOT_DIR CACHE)
endif()
set(uplot_seen "")
foreach(folder IN ITEMS ${UPLOT_DIR} $ENV{UPLOT_DIR} ${CMAKE_CURRENT_LIST_DIR}/../.cache/uplot
        /usr/local/lib/node_modules/uplot /usr/lib/node_modules/uplot)
    iqfoc_pinned(${folder} ${CMAKE_CURRENT_LIST_DIR}/../packages/uplot.sha256 uplot_wrong there)
    if(NOT uplot_wrong)
        set(UPLOT_DIR ${folder} CACHE PATH "Folder of uPlot's package" FORCE)
        return()
    endif()
    if(there)
        list(APPEND uplot_seen ${folder})
    endif()
endforeach()
if(uplot_seen)
    list(REMOVE_DUPLICATES uplot_seen)
    message(FATAL_ERROR "uPlot in ${uplot_seen} is not the version that packages/uplot.sha256 pins. `./dev build` fetches that one; or "
                        "unpack `npm pack uplot@1.6.32` and set UPLOT_DIR to its folder package/.")
endif()
# The Python package's own build gets it from PyPI (python/build_backend.py): an older version, not minified, without its licence file.
if(IQFOC_PYTHON)
    find_package(Python3 REQUIRED COMPONENTS Interpreter)
    execute_process(COMMAND ${Python3_EXECUTABLE} -c
        "from importlib.util import find_spec as f; s = f('uplot'); print(s.submodule_search_locations[0] if s else '')"
        OUTPUT_VARIABLE folder OUTPUT_STRIP_TRAILING_WHITESPACE)
    iqfoc_pinned("${folder}" ${CMAKE_CURRENT_LIST_DIR}/../packages/uplot-python.sha256 uplot_wrong)
    if(NOT uplot_wrong)
        set(UPLOT_DIR ${PROJECT_BINARY_DIR}/uplot CACHE PATH "Folder of uPlot's package" FORCE)
        file(MAKE_DIRECTORY ${UPLOT_DIR}/dist)
        file(COPY_FILE ${folder}/static/uPlot.iife.js ${UPLOT_DIR}/dist/uPlot.iife.min.js)
        file(COPY_FILE ${folder}/static/uPlot.min.css ${UPLOT_DIR}/dist/uPlot.min.css)
        # Its licence is MIT, as this project's own.
        file(READ ${CMAKE_CURRENT_LIST_DIR}/../LICENSE licence)
        string(REGEX REPLACE "Copyright [^\n]*" "Copyright (c) 2021 Leon Sorokin" licence "${licence}")
        file(WRITE ${UPLOT_DIR}/LICENSE "${licence}")
        return()
    endif()
endif()
message(FATAL_ERROR "uPlot, which the report pages embed, is missing. `./dev build` fetches it; or unpack `npm pack uplot@1.6.32` "
                    "and set UPLOT_DIR to its folder package/.")

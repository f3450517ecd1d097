# The first of ESP-IDF's two readings of a component: as a script, only to learn what it requires. No command of a project may
# be met before it has registered itself. Run by cmake -P with IQFOC_SOURCE.
set(ESP_PLATFORM 1)

macro(idf_component_register)
    message(STATUS "registered: ${ARGN}")
    return()
endmacro()

macro(read_component)
    include(${IQFOC_SOURCE}/CMakeLists.txt)
endmacro()
read_component()

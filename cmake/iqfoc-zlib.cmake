# dep::zlib from its sources in ZLIB_SOURCE_DIR: the files for reading, and those that they link.
foreach(file IN ITEMS adler32 crc32 deflate gzclose gzlib gzread gzwrite inffast inflate inftrees trees zutil)
    list(APPEND zlib_sources ${ZLIB_SOURCE_DIR}/${file}.c)
endforeach()
add_library(zlib_of_sources STATIC EXCLUDE_FROM_ALL ${zlib_sources})
target_include_directories(zlib_of_sources SYSTEM PUBLIC ${ZLIB_SOURCE_DIR})
target_compile_options(zlib_of_sources PRIVATE -w)
# Its own configure finds out whether there is a unistd.h.
target_compile_definitions(zlib_of_sources PRIVATE HAVE_UNISTD_H _GNU_SOURCE)
add_library(dep::zlib ALIAS zlib_of_sources)

# Embeds files as C arrays, so that the program needs no other file at run time:
#   iqfoc_embed(TARGET source-to-write.c name=file...)
# gives the target `const unsigned char NAME[]`, ended by a 0, for each. A header of the target declares them by hand.
# Run as a script (-P) it writes the source.
if(CMAKE_SCRIPT_MODE_FILE)
    set(text "/* Written by the build from the files named below. */\n")
    string(REPLACE "|" ";" FILES "${FILES}")
    foreach(pair IN LISTS FILES)
        string(REGEX REPLACE "=.*" "" name "${pair}")
        string(REGEX REPLACE "^[^=]*=" "" file "${pair}")
        file(READ "${file}" hex HEX)
        string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
        string(REGEX REPLACE "(............................................................)" "\\1\n" bytes "${bytes}")
        get_filename_component(short "${file}" NAME)
        string(APPEND text "/* ${short} */\nextern const unsigned char ${name}[];\nconst unsigned char ${name}[] = {\n${bytes}0x00};\n")
    endforeach()
    file(WRITE "${OUTPUT}" "${text}")
    return()
endif()

set(IQFOC_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

function(iqfoc_embed target output)
    set(files "")
    foreach(pair IN LISTS ARGN)
        string(REGEX REPLACE "^[^=]*=" "" file "${pair}")
        list(APPEND files ${file})
    endforeach()
    list(JOIN ARGN "|" pairs) # a semicolon would part the command's arguments
    add_custom_command(OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} "-DOUTPUT=${output}" "-DFILES=${pairs}" -P ${IQFOC_EMBED_SCRIPT}
        DEPENDS ${files} ${IQFOC_EMBED_SCRIPT}
        COMMENT "Embedding the report's files" VERBATIM)
    target_sources(${target} PRIVATE ${output})
endfunction()

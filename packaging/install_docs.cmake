# Part of `cmake --install`: the documents link to each other, to data that is installed elsewhere, and to parts of the
# source that are not installed. The first links stay, the second work through a symbolic link, and of the third only
# the words stay.
set(documents ${CMAKE_INSTALL_PREFIX}/share/doc/octoskin)
set(link ${documents}/hw)
message(STATUS "Installing: $ENV{DESTDIR}${link} -> ../../octoskin/hw")
file(REMOVE "$ENV{DESTDIR}${link}")
file(CREATE_LINK ../../octoskin/hw "$ENV{DESTDIR}${link}" SYMBOLIC)
list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${link})

# Removes the dead links of a document, and keeps their words.
function(drop_dead_links document)
    get_filename_component(folder ${document} DIRECTORY)
    file(READ ${document} rest)
    set(text "")
    # Each round removes the text up to a link. A list of matches would fail on brackets in a match.
    while(rest MATCHES "\\[([^][]*)\\]\\(([^()# ]+)(#[^() ]*)?\\)")
        set(whole "${CMAKE_MATCH_0}")
        set(words "${CMAKE_MATCH_1}")
        set(target "${CMAKE_MATCH_2}")
        string(FIND "${rest}" "${whole}" at)
        string(LENGTH "${whole}" length)
        math(EXPR end "${at} + ${length}")
        string(SUBSTRING "${rest}" 0 ${at} before)
        string(SUBSTRING "${rest}" ${end} -1 rest)
        if(NOT target MATCHES "^[a-z]+:" AND NOT EXISTS ${folder}/${target})
            set(whole "${words}")
        endif()
        string(APPEND text "${before}${whole}")
    endwhile()
    file(WRITE ${document} "${text}${rest}")
endfunction()

set(there "$ENV{DESTDIR}${documents}")
# Not through the symbolic link: its target stays unchanged.
file(GLOB installed ${there}/*.md ${there}/docs/*.md ${there}/docs/*/*.md ${there}/packaging/*.md)
foreach(document ${installed})
    drop_dead_links(${document})
endforeach()

# Functions that write texts with the paths of the prefix. For the prefix /usr, settings are in /etc.
set(etc ${CMAKE_INSTALL_PREFIX}/etc)
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
    set(etc /etc)
endif()

function(install_text file target)
    set(destination "$ENV{DESTDIR}${target}")
    message(STATUS "Installing: ${destination}")
    file(READ ${octoskin_packaging}/${file} text)
    string(REPLACE "/etc/default/" "${etc}/default/" text "${text}")
    string(REPLACE "/usr/bin/" "${CMAKE_INSTALL_PREFIX}/bin/" text "${text}")
    file(WRITE "${destination}" "${text}")
    file(CHMOD "${destination}" PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
    list(APPEND CMAKE_INSTALL_MANIFEST_FILES "${target}")
    set(CMAKE_INSTALL_MANIFEST_FILES "${CMAKE_INSTALL_MANIFEST_FILES}" PARENT_SCOPE)
endfunction()

# Debian requires compressed texts; -n omits the time, so that the same text gives the same file.
function(install_compressed file target)
    install_text(${file} ${target})
    execute_process(COMMAND ${octoskin_gzip} -9nf "$ENV{DESTDIR}${target}" COMMAND_ERROR_IS_FATAL ANY)
    string(APPEND target .gz)
    list(TRANSFORM CMAKE_INSTALL_MANIFEST_FILES APPEND .gz AT -1)
    set(CMAKE_INSTALL_MANIFEST_FILES "${CMAKE_INSTALL_MANIFEST_FILES}" PARENT_SCOPE)
endfunction()


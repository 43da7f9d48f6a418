# Part of `cmake --install`: units, settings and manual pages, with the paths of the prefix.
include(${octoskin_packaging}/install_functions.cmake)

foreach(service ${octoskin_services})
    install_text(${service}.service ${CMAKE_INSTALL_PREFIX}/lib/systemd/system/${service}.service)
    install_compressed(man/${service}.1 ${CMAKE_INSTALL_PREFIX}/share/man/man1/${service}.1)
    # Existing settings are not overwritten; in the package dpkg handles that.
    if(NOT EXISTS "$ENV{DESTDIR}${etc}/default/${service}")
        install_text(${service}.default ${etc}/default/${service})
    endif()
endforeach()
install_text(octoskin.sysusers ${CMAKE_INSTALL_PREFIX}/lib/sysusers.d/octoskin.conf)
if(octoskin_services MATCHES "octoskin-node")
    install_text(octoskin-node.rules ${CMAKE_INSTALL_PREFIX}/lib/udev/rules.d/60-octoskin-node.rules)
endif()
install_compressed(debian/changelog ${CMAKE_INSTALL_PREFIX}/share/doc/octoskin/changelog)

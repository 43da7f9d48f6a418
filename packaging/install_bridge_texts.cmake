# Part of `cmake --install`, component bridge: its unit, settings, manual page and history.
include(${octoskin_packaging}/install_functions.cmake)

install_text(octoskin-bridge.service ${CMAKE_INSTALL_PREFIX}/lib/systemd/system/octoskin-bridge.service)
install_compressed(man/octoskin-bridge.1 ${CMAKE_INSTALL_PREFIX}/share/man/man1/octoskin-bridge.1)
if(NOT EXISTS "$ENV{DESTDIR}${etc}/default/octoskin-bridge")
    install_text(octoskin-bridge.default ${etc}/default/octoskin-bridge)
endif()
install_compressed(debian/changelog ${CMAKE_INSTALL_PREFIX}/share/doc/octoskin-bridge/changelog)

# Part of `cmake --install`, component lab: its manual page and history.
include(${octoskin_packaging}/install_functions.cmake)

install_compressed(man/octoskin-lab.1 ${CMAKE_INSTALL_PREFIX}/share/man/man1/octoskin-lab.1)
install_compressed(debian/changelog ${CMAKE_INSTALL_PREFIX}/share/doc/octoskin-lab/changelog)

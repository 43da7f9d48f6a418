# The firmware's compiler and flags, and a machine to run the result on: QEMU's model of ARM's MPS2 board with a
# Cortex-M4F (AN386). It is not the flashed board, but has its instruction set; start-up and linker script are in
# tests/support/target.
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi-cortex-m4.cmake)
find_program(OCTOSKIN_QEMU qemu-system-arm)
if(NOT OCTOSKIN_QEMU)
    message(FATAL_ERROR "qemu-system-arm not found (Debian package qemu-system-arm; ./check installs it)")
endif()
# Arguments of a program follow by -append: ... node_test -append '--gtest_filter=Recovery.*'
set(CMAKE_CROSSCOMPILING_EMULATOR ${OCTOSKIN_QEMU} -machine mps2-an386 -serial none -monitor none -display none
    -semihosting-config enable=on,target=native -kernel)

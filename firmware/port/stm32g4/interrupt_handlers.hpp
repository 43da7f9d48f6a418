// Functions that start-up calls or that the vector table contains. The application defines the peripherals'
// handlers, since it owns the objects.
#pragma once

extern "C" {

// fault_handlers.cpp
void nmi_handler();
void fault_handler();
void unexpected_interrupt();

// the application
[[noreturn]] void application();
void can_interrupt();
void timer_interrupt();
void i2c1_interrupt();
void i2c2_interrupt();
void i2c3_interrupt();
void i2c4_interrupt();
void data_ready_interrupt();
void serial_interrupt();
}

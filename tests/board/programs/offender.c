// Does one forbidden thing at reset, then sleeps: what octoskin_board makes of such an image.
#include "tiny.h"

void reset(void) {
    REG(0x48000014) = 1;  // GPIOA is not clocked
    for (;;) __asm volatile("wfi");
}

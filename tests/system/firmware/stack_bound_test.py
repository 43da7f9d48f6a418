#!/usr/bin/env python3
"""toolchains/stack_bound on small programs whose stack is known: what it must add up, and what it must refuse."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
SCRIPT = """
stack_size = 1024;
fault_stack_size = 256;
SECTIONS {{ .text 0x08000000 : {{ *(.text*) }} }}
"""
# Assembler, so that every frame is known.
FUNCTIONS = {
    "reset_handler": "push {r4, lr}; sub sp, #32; bl middle; bl leaf; add sp, #32; pop {r4, pc}",  # 8 + 32
    "middle": "push {r4-r7, lr}; vpush {d8-d9}; bl leaf; vpop {d8-d9}; pop {r4-r7, pc}",             # 20 + 16
    "leaf": "sub sp, #100; add sp, #100; bx lr",                                                     # 100
    "tick": "str r0, [sp, #-8]!; add sp, #8; bx lr",                                                 # 8
    "tock": "push {lr}; bl leaf; pop {pc}",                                                          # 4 + 100
    "fault": "b leaf",                                                                               # 100
}
TABLE = "interrupt 0 tick\ninterrupt 1 tick\ninterrupt 1 tock\nfault fault\n"


class StackBound(unittest.TestCase):
    def run_on(self, changed=(), table=TABLE):
        functions = FUNCTIONS | dict(changed)
        text = ".syntax unified\n.cpu cortex-m4\n.fpu fpv4-sp-d16\n.thumb\n.text\n"
        for name, body in functions.items():
            text += f".global {name}\n.type {name}, %function\n.thumb_func\n{name}:\n" + body.replace("; ", "\n") + "\n"
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "a.s").write_text(text)
            (folder / "a.ld").write_text(SCRIPT.format())
            (folder / "table").write_text(table)
            subprocess.run(["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-nostdlib",
                            "-Wl,--entry=reset_handler", "-T", folder / "a.ld", folder / "a.s", "-o", folder / "a.elf"],
                           check=True, capture_output=True)
            done = subprocess.run([SOURCE / "toolchains/stack_bound", "--elf", folder / "a.elf", "--table", folder / "table"],
                                  capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def refuses(self, why, changed=(), table=TABLE):
        code, _, error = self.run_on(changed, table)
        self.assertEqual(code, 1)
        self.assertIn(why, error)

    def test_adds_the_deepest_chain_and_an_interrupt_of_each_priority(self):
        code, out, error = self.run_on()
        self.assertEqual((code, error), (0, ""))
        # 40 + 36 + 100; 108 + 8 of priority 0; 108 + 104 of priority 1.
        self.assertIn(f"stack: at most {176 + 116 + 212} of 1024 bytes", out)
        self.assertIn("reset_handler 40 > middle 36 > leaf 100", out)
        self.assertIn("fault stack: at most 100 of 256 bytes", out)

    def test_refuses_a_stack_that_is_too_full(self):
        self.refuses("a stack is too small", {"leaf": "sub sp, #500; add sp, #500; bx lr"})

    def test_refuses_a_fault_stack_that_is_too_full(self):
        self.refuses("a stack is too small", {"fault": "sub sp, #200; add sp, #200; bx lr"})

    def test_refuses_recursion(self):
        self.refuses("recursion: middle > leaf > middle", {"leaf": "push {lr}; bl middle; pop {pc}"})

    def test_refuses_a_frame_of_no_fixed_size(self):
        self.refuses("leaf: a frame of no fixed size", {"leaf": "sub.w sp, sp, r0; bx lr"})

    def test_refuses_a_pointer_that_nobody_explained(self):
        for jump in ("push {lr}; blx r3; pop {pc}", "bx r3"):
            self.refuses("leaf calls through a pointer", {"leaf": jump})

    def test_follows_a_pointer_by_the_table(self):
        changed = {"leaf": "push {lr}; blx r3; pop {pc}", "far": "sub sp, #60; add sp, #60; bx lr"}
        code, out, _ = self.run_on(changed, TABLE + "call leaf -> far | tick\n")
        self.assertEqual(code, 0)
        self.assertIn("reset_handler 40 > middle 36 > leaf 4 > far 60", out)

    def test_refuses_a_table_that_is_out_of_date(self):
        self.refuses("the table's caller 'gone' calls nothing", table=TABLE + "call gone -> leaf\n")
        self.refuses("the table's target 'gone' is no function", {"leaf": "bx r3"}, TABLE + "call leaf -> gone\n")
        self.refuses("the image has no function gone", table="interrupt 0 gone\nfault fault\n")
        self.refuses("not understood", table=TABLE + "cal leaf -> tick\n")


if __name__ == "__main__":
    if shutil.which("arm-none-eabi-gcc") is None:
        print("skipped: no arm-none-eabi-gcc")
        sys.exit(77)
    unittest.main()

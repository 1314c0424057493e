"""What things cost on the ESP32, in machine instructions: the one table of every assumption behind the modelled times.

The measured figures behind it were counted while stock MicroPython ran in an instruction-counting ESP32 emulator:

    viper loop, an iteration: while / for range / with one ptr16 read     13 / 21 / 26
    bytecode loop: empty / one integer add and mask                       280 / 485
    function call / method call with attribute read                       1184 / 1690
    I2C at 400 kHz, bus time included: 4 / 64 data bytes                  0.19 / 1.5 ms (the simulated bus takes as long)

Viper code is not assumed but counted: `machine_code` counts the instructions of each block in what mpy-cross emits for the ESP32. The
loops above come out as 12, 14 and 26. Bytecode is counted in operations of the syntax tree, which MicroPython's bytecode follows one to one.
A condition of several parts is counted whole, though it may be decided by the first. Floats are not told from integers: the loop has none.
"""

import ast

CPI = 2  # cycles an instruction: viper 1.3-2, the bytecode interpreter 2-2.5
CLOCK_MHZ = 240

RUNTIME_CALL = 60  # of viper code into the runtime: boxing an argument, finding a buffer, a division with its sign

OPERATION = 35  # one bytecode: the empty loop is 8 of them in 280, add and mask 6 in 205
GLOBAL = 60  # beyond the operation: the look-up of a global name
ATTRIBUTE = 250  # beyond the operation: reading or writing one; half of what a method call with an attribute read costs above a call
SUBSCRIPT = 120  # beyond the operation: the index unpacked, the item boxed
ENTRY = 950  # a function called: 1184 less the five operations at the call and in the function
BUILTIN = 300  # a built-in function called: no frame is made


def us(instructions):
    """Modelled time on the ESP32, us."""
    return instructions * CPI / CLOCK_MHZ


def statement(node, own_functions, constants):
    """Instructions of one simple statement or expression of bytecode; blocks nested in it are not counted.

    node: ast node. own_functions: names of the firmware's functions, whose entry is counted where they begin. constants: names that
    are constants of the module, put in by the compiler.
    """
    total = 0
    for part in ast.walk(node):
        if isinstance(part, (ast.BinOp, ast.UnaryOp, ast.Compare, ast.AugAssign, ast.Return, ast.keyword)):
            total += OPERATION * (len(part.ops) if isinstance(part, ast.Compare) else 1)
        elif isinstance(part, ast.BoolOp):
            total += OPERATION * (len(part.values) - 1)
        elif isinstance(part, ast.Constant):
            total += OPERATION
        elif isinstance(part, ast.Name):
            total += OPERATION
            if part.id not in constants and part.id[:1].isupper():
                total += GLOBAL
        elif isinstance(part, ast.Attribute):
            total += OPERATION + ATTRIBUTE
        elif isinstance(part, ast.Subscript):
            total += OPERATION + SUBSCRIPT
        elif isinstance(part, ast.Call):
            total += OPERATION
            name = part.func.attr if isinstance(part.func, ast.Attribute) else getattr(part.func, "id", "")
            if name not in own_functions:
                total += BUILTIN
            if isinstance(part.func, ast.Name):
                total += GLOBAL
        elif isinstance(part, (ast.IfExp, ast.Starred, ast.JoinedStr, ast.Raise)):
            total += OPERATION
    return total

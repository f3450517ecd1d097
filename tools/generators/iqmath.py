"""iqmath arithmetic | iqmath functions: TI's IQmath by its documents next to iqfoc, by build/host/tests/iqmath_table.

    <!-- figures: iqmath arithmetic -->
"""


def generate(program, arguments):
    if arguments not in (["arithmetic"], ["functions"]):
        raise ValueError(f"expected `arithmetic` or `functions`, got {arguments}")
    return program.output(str(program.path.parent / "tests" / "iqmath_table"), *arguments)

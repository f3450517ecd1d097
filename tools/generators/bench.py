"""bench: the table of `./dev bench` for both emulated targets."""


def generate(program, arguments):
    if arguments:
        raise ValueError(f"expected no arguments, got {arguments}")
    return program.output("bench/run.sh", "--markdown")

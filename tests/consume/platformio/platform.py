from platformio.public import PlatformBase


class HerePlatform(PlatformBase):
    """Nothing but the tools that the machine has."""

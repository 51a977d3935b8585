"""Messages as codes with arguments; the words are in catalogues, one folder of .po files a language."""

from thetascope.messages.message import Argument, Message, text_of, words

__all__ = ["Argument", "Message", "text_of", "words"]

"""What a user taught the embedded network: questions of any domain, about pictures like theirs."""

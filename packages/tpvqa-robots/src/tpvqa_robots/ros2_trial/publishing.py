"""Tells a trial on topics while it runs."""

from collections.abc import Callable
from typing import Any

from tpvqa.events import Event, TrialState
from tpvqa.events.events import Acting, Decided
from tpvqa_robots.ros2.link import Link, latched, said
from tpvqa_robots.ros2.typed import fact_messages, stamped
from tpvqa_robots.ros2_trial.telling import belief_values, episode_values


class Topics:
    """PREFIX/episode and PREFIX/belief.

    Args:
        link: The node.
        prefix: Of the topics.
    """

    def __init__(self, link: Link, prefix: str):
        from tpvqa_interfaces.msg import Belief, Episode

        self._link = link
        self._episode_kind: Callable[..., Any] = Episode
        self._belief_kind: Callable[..., Any] = Belief
        self._episodes = link.speaker(Episode, f"{prefix}/episode", said(200))
        self._beliefs = link.speaker(Belief, f"{prefix}/belief", latched())

    def told(self, episode: str, feedback: Callable[[Any], None]) -> Callable[[Event], None]:
        """A listener to one trial's events.

        Args:
            episode: Its folder.
            feedback: Told of where it stands at every decision and action.
        """
        state = TrialState()

        def listen(event: Event) -> None:
            nonlocal state
            state = state.after(event)
            now = self._link.now()
            message = self._episode_kind(**episode_values(state, event, episode))
            stamped(message.stamp, now)
            self._episodes.publish(message)
            believed = belief_values(state, event, episode)
            if believed is not None:
                facts = ((each["fact"], each["probability"]) for each in believed.pop("facts"))
                belief = self._belief_kind(**believed, facts=fact_messages(facts))
                stamped(belief.stamp, now)
                self._beliefs.publish(belief)
            if isinstance(event, Decided | Acting):
                feedback(message)

        return listen

"""Public name of `fvcollapse.measure.observation`: what is seen of a flow."""

from fvcollapse.measure.observation import flow_case as flow_case

// What the status says of a sensor, in one of five words; the colour of its cone follows from it.

/** Newest reading older than this: the sensor is silent. */
const SILENT_S = 3;
const SILENT_WHY = {
  usable: 'no readings arrive',
  recorded: 'none of its readings went into the map lately: it saw no target, or they were rejected',
};

/**
 * @param {object} node of the status @param {object} sensor of `nodes.sensors`
 * @returns {{state: 'used' | 'nothing' | 'rejected' | 'faulty' | 'silent', why: string}}
 */
export function sensorState(node, sensor) {
  const fault = faultOf(sensor);
  if (fault) return { state: 'faulty', why: fault };
  if (sensor.age_s === null || sensor.age_s > SILENT_S || sensor.state === null) {
    const why = SILENT_WHY[node.verdict] ?? `its node is ${words(node.verdict)}`;
    return { state: 'silent', why };
  }
  if (sensor.rejected === null) return { state: 'used', why: 'its newest reading is in the map, or waits' };
  if (sensor.rejected === 'no_return') return { state: 'nothing', why: 'it sees no target in its range' };
  return { state: 'rejected', why: `its newest reading was rejected: ${words(sensor.rejected)}` };
}

const words = (name) => name.replaceAll('_', ' ');

function faultOf({ state, fault, disputed, camera }) {
  if (state !== null && state !== 'ranging') return `${words(state)}, fault: ${words(fault ?? 'not known')}`;
  if (disputed) return 'a second sender uses its name';
  if (!camera?.contradicts) return null;
  return `its ranges contradict the camera${camera.fault ? `: ${words(camera.fault)}` : ''}`;
}

/**
 * "node sensor" of each sensor of the status, with its state.
 * @returns {Map<string, {state: string, why: string, name: string}>}
 */
export function sensorStates(status) {
  const states = new Map();
  for (const node of status.nodes)
    for (const sensor of node.sensors)
      states.set(`${node.id} ${sensor.index}`, {
        ...sensorState(node, sensor),
        name: `${node.name} / ${sensor.name}`,
      });
  return states;
}

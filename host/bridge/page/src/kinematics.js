// Where the links are, from the joints of the daemon's `describe`.
import * as THREE from 'three';
import { matrixOf } from './poses.js';

function motionOf(joint, position) {
  const axis = new THREE.Vector3(...joint.axis);
  if (joint.kind === 'prismatic') return new THREE.Matrix4().setPosition(axis.multiplyScalar(position));
  if (joint.kind === 'fixed') return new THREE.Matrix4();
  return new THREE.Matrix4().makeRotationAxis(axis.normalize(), position);
}

export class Kinematics {
  /** @param {object} robot the answer to `describe` */
  constructor(robot) {
    this.joints = robot.joints;
    this.baseLink = robot.base_link;
    this.T_map_base = matrixOf(robot.T_root_map).invert().multiply(matrixOf(robot.T_root_base));
    /** Joints that have a position of their own, in the rig's order: that of a query's configuration. */
    this.order = robot.joint_sources.flatMap((source) => source.joints);
  }

  /** @param {Map<string, number>} positions rad or m; a joint without one counts as 0 */
  positionOf(joint, positions) {
    if (!joint.mimic) return positions.get(joint.name) ?? 0;
    return joint.mimic.multiplier * (positions.get(joint.mimic.joint) ?? 0) + joint.mimic.offset;
  }

  /** @param {Map<string, number>} positions @returns {Map<string, THREE.Matrix4>} T_map_link of the base and below */
  linkPoses(positions) {
    const poses = new Map([[this.baseLink, this.T_map_base.clone()]]);
    for (const joint of this.joints) {
      // parents first
      const T_map_parent = poses.get(joint.parent);
      if (!T_map_parent) continue;
      const T_map_child = T_map_parent.clone()
        .multiply(matrixOf(joint.T_parent_joint))
        .multiply(motionOf(joint, this.positionOf(joint, positions)));
      poses.set(joint.child, T_map_child);
    }
    return poses;
  }
}

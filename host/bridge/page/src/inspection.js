// `window.octoskin`: what the page shows, as numbers, for tests and for people with a console. Reading changes nothing.
import { centreOf } from './lattice.js';
import { percentile } from './map_client.js';
import { poseOf } from './poses.js';

/** Of the newest 600 maps. */
function figuresOf(values) {
  const [p50, p95, max] = [0.5, 0.95, 1].map((share) => percentile(values, share));
  return { last: values.at(-1) ?? null, p50, p95, max, count: values.length };
}

/** @param {object} page of main.js */
export function inspection(page) {
  return {
    /** Keys of the voxels with a drawn face, "x,y,z" each. @param {'occupied' | 'unknown' | 'free'} [layer] */
    drawnKeys: (layer) => page.layer.drawnKeys(layer),

    /** T_map_link of the drawn arm: p in metres, q as x, y, z, w. */
    linkPoses: () =>
      Object.fromEntries([...(page.arm.robot?.drawnPoses() ?? [])].map(([name, matrix]) => [name, poseOf(matrix)])),

    /** The robot's visuals by link, why other links have their capsules, and how many files came. */
    visuals: () => ({
      drawn: page.arm.robot?.drawnVisuals() ?? {},
      missing: Object.fromEntries(page.arm.robot?.missing ?? []),
      fetched: page.arm.meshFiles.fetched,
    }),

    /** "#rrggbb" of the drawn cones, by "node sensor". */
    coneColours: () => page.arm.sensors?.drawnColours() ?? {},

    /** The voxel under a pixel of the canvas, with `centre_m`; the page shows it, too. */
    pick: async (x_px, y_px) => {
      const voxel = await page.picking.pickAt(x_px, y_px);
      return voxel && { ...voxel, centre_m: centreOf(voxel.key, page.map.newest.resolution_m) };
    },

    /** The pixel of a point, metres, map frame. */
    pixelOf: (p_map) => page.scene.pixelOf(p_map),

    /** The camera of the scene: metres, map frame, up is z; `fov_deg`: of the height; size in CSS pixels. */
    camera: () => ({
      position: page.scene.camera.position.toArray(),
      target: page.scene.controls.target.toArray(),
      fov_deg: page.scene.camera.fov,
      width: page.scene.element.clientWidth,
      height: page.scene.element.clientHeight,
    }),

    /** The newest status, and the newest positions of the joints by name, rad or m, as they arrived. */
    status: () => page.status ?? null,
    joints: () => Object.fromEntries(page.arm.positions),

    /** Shows a time of the last minute, bus seconds; null: live. */
    showAt: (time_s) => page.timeline.showAt(time_s),

    /** Asks about a posture. @param {Object<string, number>} positions rad or m */
    setPosture: (positions) => page.posture.set(new Map(Object.entries(positions))),

    /** The newest answer about a posture, and the state of each link that is coloured. */
    posture: () => ({ answer: page.posture.newest ?? null, links: Object.fromEntries(page.posture.linkStates) }),

    /** Counts, times and memory. Milliseconds of the page's and of the map's thread for a map; bytes. */
    stats: async () => {
      const worker = await page.map.figures();
      const drawn = page.layer.figures();
      return {
        ...page.connection.counts,
        maps: worker.updates,
        mapsMalformed: worker.malformed,
        mapGaps: page.map.gaps,
        time_s: page.map.newest?.time_s ?? null,
        shown_s: page.map.newest?.shown_s ?? null,
        occupied: page.map.newest?.occupied ?? 0,
        history: page.map.newest?.history ?? null,
        faces: drawn.faces,
        meshes: drawn.meshes,
        frameBytes: drawn.bytes + worker.bytes,
        historyBytes: worker.historyBytes,
        mainMs: figuresOf(page.main_ms),
        workerMs: figuresOf(page.map.worker_ms),
        drawings: page.scene.drawn.count,
      };
    },
  };
}

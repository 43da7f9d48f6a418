#include "host/apps/monitor/status_meanings.hpp"

#include <array>

namespace octoskin {
namespace {

// Word for word as docs/status.md has them; tests hold the two equal, and complete by a status of the daemon.
constexpr std::array kStatusMeanings = {
    Meaning{"", "octoskin", "program, version and commit"},
    Meaning{"", "uptime_s", "seconds since the daemon began"},
    Meaning{"", "rig", "the name of the rig"},
    Meaning{
        "", "links_without_body",
        "links of the robot that move and have a <visual>, but no body that covers them, nor a link fixed to "
        "them that has one: nothing of them is taken out of images and ranges"},
    Meaning{"", "links_unknown",
            "those of links_without_body that the rig's robot.links_without_body does not list: as long as "
            "there is one, a query answers unknown instead of free"},
    Meaning{"", "links_with_borrowed_body",
            "an object, link to link: links that move and have a <visual>, but no body of their own, each "
            "with the one that is fixed to it and whose body is taken for it"},
    Meaning{"", "problems",
            "what is wrong, a sentence each, the most fundamental first: an empty map has its reason there"},
    Meaning{"", "can", "the interface, below"},
    Meaning{"", "clock", "the bus's time, below"},
    Meaning{"", "nodes", "a list, one object for each node of the rig, below"},
    Meaning{"", "joint_states",
            "whether joint states come from one sender, and whether they are true, below"},
    Meaning{"", "joints_socket", "joint states from this machine, below; null without --joints"},
    Meaning{"", "recording", "the recording that is made, or the last one, below; null without"},
    Meaning{"", "camera", "the depth camera, below; null without one"},
    Meaning{"", "latency",
            "how late readings come onto the map: since the frame that completed them, and since they were "
            "taken, below"},
    Meaning{"", "map", "the fused map, below"},
    Meaning{"", "reloads", "rig, robot and mapping read again, below"},
    Meaning{"", "log", "the daemon's own log on its way to standard error, below"},
    Meaning{"", "account",
            "one object for each of \"CAN frames\", \"readings\", \"joint samples\" and \"depth frames\", "
            "below; counts since the newest reload"},
    Meaning{"can", "interface", "the interface's name"},
    Meaning{"can", "state", "up, error_passive, bus_off, down or absent: the worst that holds"},
    Meaning{"can", "why", "why it is not up, with what to do; empty if it is"},
    Meaning{"can", "listen_only", "the daemon transmits nothing (--listen-only)"},
    Meaning{"can", "received", "frames that came; the echoes of those sent, too"},
    Meaning{
        "can", "sent",
        "frames handed to the interface: two a second, SYNC and FOLLOW_UP, and two more where the time came "
        "into doubt; none with --listen-only"},
    Meaning{"can", "not_sent",
            "frames that the interface did not take, as it was not up or its queue was full: they are not "
            "sent later, and nodes lose their time if it goes on"},
    Meaning{"can", "foreign_follow_ups",
            "FOLLOW_UP of other hosts, which would set the time: left out; none with --listen-only"},
    Meaning{"can", "busy_s",
            "for how many seconds this rig's frames have kept the bus busy, at worst; what grows in a second "
            "is the bus's load. Frames of others the kernel keeps back"},
    Meaning{"can", "error_frames",
            "the adapter's own words about errors: a wrong bit rate or sample point, a missing terminator, a "
            "disturbed line, nobody who acknowledges. A few when something is plugged in are usual"},
    Meaning{"can", "dropped_by_kernel",
            "frames that the kernel threw away, as the daemon was held up for too long to read them"},
    Meaning{
        "can", "malformed",
        "what the interface gave that is no CAN frame: a driver's defect, or a foreign program behind fd:N"},
    Meaning{"can", "bus_off", "how often the adapter left the bus after too many errors of its own"},
    Meaning{"can", "went_down", "how often the interface went down"},
    Meaning{"can", "reopened",
            "how often the interface was opened again: it had been removed, as an adapter that is unplugged, "
            "or its frames could not be chosen anew at a reload"},
    Meaning{"clock", "known", "the bus's time is known; without it nothing that comes over the bus is used"},
    Meaning{"clock", "steps_back",
            "how often the receive stamps, which are wall time, jumped back: the clock of this machine was "
            "set. The next exchange of SYNC and FOLLOW_UP settles it"},
    Meaning{
        "clock", "steps_ahead",
        "how often they jumped ahead by over 0.14 s: the clock was set, or the bus was silent for so long"},
    Meaning{"clock", "stamps_ignored",
            "receive stamps that jumped alone, without others that agreed: of other interfaces in one log, "
            "or a driver's mistake"},
    Meaning{"clock", "relocks",
            "how often two exchanges agreed on another offset between wall time and the bus's time than "
            "before, as after a step"},
    Meaning{"clock", "times_back",
            "how often the bus's own time went back by over 0.15 s: the host that sends SYNC began anew"},
    Meaning{"clock", "times_ahead",
            "how often it went ahead by over a second more than passed: another host sends SYNC, or its "
            "clock was set. The map stays as old as it was"},
    Meaning{"clock", "follow_up_outliers",
            "exchanges that disagreed with the other host's clock as it was known (with --listen-only); the "
            "first ones after it was set are among them"},
    Meaning{"nodes", "id", "its node id"},
    Meaning{"nodes", "name", "its name in the rig"},
    Meaning{"nodes", "verdict",
            "usable, or why it is not: other_version, quarantined, babbling, absent, lost, time_suspect, "
            "info_incomplete, info_mismatch, build_refused"},
    Meaning{"nodes", "reason", "of info_mismatch and the like, what it says and what the rig has; else null"},
    Meaning{"nodes", "state",
            "its own word in its newest heartbeat; bring-up has each with its remedy; null before the first"},
    Meaning{"nodes", "age_s", "since it was heard; null: never, or the time is not known"},
    Meaning{"nodes", "degraded_sensors", "how many of its sensors are not well, by its newest heartbeat"},
    Meaning{"nodes", "clock_known", "its readings can be dated now"},
    Meaning{"nodes", "clock_ppm",
            "seconds of the bus's time per second of its own, less 1, in millionths: negative if its clock "
            "is fast. Over 250 either way its readings are refused as clock_in_doubt; null: not known"},
    Meaning{"nodes", "clock_error_ms",
            "bound on the error of its time now; it grows with silence; null: not known"},
    Meaning{"nodes", "refused_share",
            "of its readings within the last second, those that were refused for their time, their number or "
            "their sender; null: no more than 0.05"},
    Meaning{"nodes", "refused_most", "why most of these were, a name of account.md; null: no more than that"},
    Meaning{
        "nodes", "clock_contradictions",
        "answers to SYNC under its id that contradicted one to the same SYNC (sync_contradicted): another "
        "sender"},
    Meaning{
        "nodes", "restarts",
        "how often it started anew by its own heartbeat; many: its supply, its watchdog or another sender"},
    Meaning{"nodes", "registers",
            "a list, one object for each register that reads otherwise than it is written, below; empty if "
            "none does"},
    Meaning{"nodes", "sensors", "a list, one object for each sensor, below"},
    Meaning{"nodes.registers", "register", "its index, 0 to 255"},
    Meaning{"nodes.registers", "written", "what was written to it"},
    Meaning{"nodes.registers", "read", "what it reads"},
    Meaning{"nodes.registers", "alike",
            "three or more sensors of the node read it so: this type of part is so, and nothing is withheld "
            "for it"},
    Meaning{"nodes.registers", "sensor",
            "the one that reads it so, by its number on the node; null if it is alike"},
    Meaning{"nodes.registers", "sensors", "how many had shown it when it was told"},
    Meaning{"nodes.sensors", "index", "its number on the node"},
    Meaning{"nodes.sensors", "name", "its name in the rig"},
    Meaning{
        "nodes.sensors", "state",
        "its node's word in the newest SENSOR_HEALTH; null: not known, as none came yet, or for 3 s neither "
        "that nor a reading"},
    Meaning{"nodes.sensors", "fault",
            "why it is not well, by the same message; bring-up has each with its remedy; null: not known"},
    Meaning{"nodes.sensors", "received", "readings that came"},
    Meaning{"nodes.sensors", "lost",
            "readings that its node sent and that never came, exact as of the newest SENSOR_HEALTH"},
    Meaning{"nodes.sensors", "age_s",
            "since its newest reading came; null: none yet, or the time is not known"},
    Meaning{"nodes.sensors", "range_m",
            "of its newest reading, as the sensor has it: a distance only where device_status is 9. Beside a "
            "status such as 4, no target, it is noise; not there before the first"},
    Meaning{"nodes.sensors", "sigma_m",
            "the standard deviation that the sensor gives its newest range; not there before the first"},
    Meaning{"nodes.sensors", "device_status",
            "the sensor's own status of it: 9 is a valid range, protocol.md has the others; not there before "
            "the first"},
    Meaning{"nodes.sensors", "zone", "which of its zones it looked through; not there before the first"},
    Meaning{"nodes.sensors", "rejected",
            "why the newest reading was not used, a name of account.md; null: it was, or waits"},
    Meaning{"nodes.sensors", "contradictions",
            "readings that cannot be of the sender of those before: their number was here with other "
            "contents, or goes back while their time does not (contradicts_reading). One may be a damaged "
            "frame"},
    Meaning{"nodes.sensors", "strays",
            "readings refused for their time or number that came between two of the sensor's own that lack "
            "none: damaged frames, or another sender's"},
    Meaning{"nodes.sensors", "second_sender",
            "another sender speaks under its name: it is disputed, or two strays came within 2.5 s"},
    Meaning{"nodes.sensors", "disputed",
            "its readings stay out of the map (sensor_disputed): two contradictions came within a second, or "
            "over a quarter as many strays as it has readings, and the last is no second ago"},
    Meaning{"nodes.sensors", "reflexes",
            "how often it sent REFLEX: something came closer than reflex_below_m"},
    Meaning{"nodes.sensors", "reflex_below_m", "its limit in the rig; 0: none"},
    Meaning{"nodes.sensors", "reflex_m", "how close what made it do so last was; null: never"},
    Meaning{"nodes.sensors", "camera", "what the camera says of it, below; null without a camera"},
    Meaning{"nodes.sensors.camera", "verdict",
            "agrees: each fault that would have changed its ranges has enough evidence against it; "
            "contradicts; or cannot_tell: doubt has why"},
    Meaning{"nodes.sensors.camera", "contradicts",
            "it contradicts the camera: swapped with another, stuck, or not where the rig has it"},
    Meaning{"nodes.sensors.camera", "fault",
            "what it ranges like: ranges_too_long, ranges_too_short, often_short, turned or exchanged; null: "
            "none of these"},
    Meaning{
        "nodes.sensors.camera", "doubt",
        "why it is cannot_tell: too_few_comparisons, a fault would not have shown yet; ambiguous, there is "
        "too little evidence for a fault, and too little against it; camera_not_known, the other sensors do "
        "not show well enough where the camera is; camera_is_off, or likely; joint_is_off, alone or beside "
        "the camera, or likely; several_contradict, more than two sensors do; null: it is not"},
    Meaning{"nodes.sensors.camera", "not_excluded",
            "a list, the faults that it may have by what was compared; turned and exchanged are in it until "
            "each turn and each exchange has been excluded, also those that would not have changed a range"},
    Meaning{"nodes.sensors.camera", "refused",
            "its readings stay out of the map (contradicts_camera): it contradicts the camera, no fewer "
            "others agree with it, and the mapping refuses such sensors"},
    Meaning{"nodes.sensors.camera", "compared", "ranges for which the camera predicted a surface"},
    Meaning{"nodes.sensors.camera", "fitted",
            "those of them that were about what it predicted; a few centimetres off still are, and up to 12 "
            "cm before a surface that the camera sees from behind: a sensor that contradicts it may fit all "
            "the same"},
    Meaning{"nodes.sensors.camera", "agreed",
            "comparisons in which it saw a surface where the camera sees one"},
    Meaning{"nodes.sensors.camera", "in_free_space",
            "comparisons in which it saw a surface where the camera sees through"},
    Meaning{"nodes.sensors.camera", "behind_surface",
            "comparisons in which it saw free space through a surface that the camera sees"},
    Meaning{"joint_states", "second_sender",
            "two senders are heard, or were within the last second: neither is used"},
    Meaning{"joint_states", "contradictions",
            "how often two senders under the joint node of the bus contradicted each other"},
    Meaning{"joint_states", "jumped",
            "the joint that was last further from the sample before it than the arm moves in that time; "
            "null: none was"},
    Meaning{"joint_states", "jump_age_s", "since such a sample was rejected; null: none was"},
    Meaning{
        "joint_states", "off_joint",
        "the joint that is not where its joint states say, which explains what several sensors contradict, "
        "and no sensor is named meanwhile; null: none"},
    Meaning{"joint_states", "off_by",
            "by about how much it is further, radians, metres of a prismatic joint; null: none is off"},
    Meaning{"joint_states", "or_camera",
            "an error of the camera explains about as much: which of the two is off is not known"},
    Meaning{"joints_socket", "samples", "samples that came, of the right form"},
    Meaning{"joints_socket", "displaced",
            "datagrams that gave way to newer ones: the daemon was held up while 1024 waited, or they come "
            "quicker than it takes them beside the bus"},
    Meaning{
        "joints_socket", "surplus",
        "datagrams dropped as they came, beyond 2048 a second of one program, or of a ninth program while "
        "eight send samples: what the others send is taken all the same"},
    Meaning{"joints_socket", "thinned",
            "samples left out, as they came sooner after the one before than the rig's rate has it: usual "
            "for a quick driver"},
    Meaning{"joints_socket", "second_sender",
            "samples left out, as more than one program sends some, or did within the last second"},
    Meaning{"joints_socket", "rate_hz", "samples that came within the newest second"},
    Meaning{"joints_socket", "above_rate",
            "that is over 1.3 times joints.rate_hz of the rig: what is beyond it is thinned, and of no use"},
    Meaning{"joints_socket", "joint_node_ignored",
            "frames of the rig's joint node on the bus, which is not the source with --joints"},
    Meaning{"joints_socket", "not_a_number",
            "refused: a word that is no finite number, or a comma without a number on each side"},
    Meaning{"joints_socket", "wrong_count",
            "refused: neither as many numbers as the rig has joints, nor one more, the time"},
    Meaning{"joints_socket", "time_off",
            "refused: its time is over 1 s from when it was read, or it has none and was not read for so "
            "long. CLOCK_MONOTONIC of this machine in seconds is wanted; wall time is what mostly came"},
    Meaning{"joints_socket", "too_large",
            "refused: a position beyond +-8.38 rad (or m); degrees are what mostly came"},
    Meaning{"joints_socket", "too_long", "refused: over 1024 bytes"},
    Meaning{"joints_socket", "senders",
            "a list, one object for each program heard within the last second, below; more than one: none is "
            "used"},
    Meaning{"joints_socket.senders", "pid",
            "its process; 0: one that cannot be seen from here, as in another container, and all of those "
            "count as one"},
    Meaning{"joints_socket.senders", "uid", "its user; 0 where the process cannot be seen"},
    Meaning{"joints_socket.senders", "program", "its name; empty: not known"},
    Meaning{"joints_socket.senders", "address", "that its socket is bound to; empty: to none"},
    Meaning{"joints_socket.senders", "samples", "samples that came of it"},
    Meaning{"joints_socket.senders", "age_s", "since the newest of them"},
    Meaning{"recording", "state", "recording, finishing, ended or failed"},
    Meaning{"recording", "folder", "where it is written"},
    Meaning{"recording", "error", "why it failed; empty if it has not"},
    Meaning{"recording", "seconds", "how long it is"},
    Meaning{"recording", "can_frames", "frames of the bus that are in it"},
    Meaning{"recording", "depth_frames", "depth frames that are in it"},
    Meaning{"recording", "commits",
            "joint samples, readings and depth frames that went into the map meanwhile"},
    Meaning{"recording", "lost_can",
            "frames of the bus that the disk could not take in time: they change no voxel of a replay"},
    Meaning{"recording", "lost_commits",
            "measurements that the disk could not take in time: a replay makes another map"},
    Meaning{"recording", "lost_depth",
            "depth frames that the disk could not take in time, or with depth beyond 32.767 m: a replay "
            "makes another map"},
    Meaning{"recording", "is_complete", "nothing that the map was made of is missing in it"},
    Meaning{"recording", "ended_early",
            "why it ended though nobody asked for that and its time was not over: the bus's time leapt, "
            "the daemon read its files anew or ended; empty otherwise"},
    Meaning{"camera", "open", "it is open"},
    Meaning{"camera", "why", "why it is not; empty if it is"},
    Meaning{"camera", "frames", "frames that came"},
    Meaning{"camera", "displaced", "frames that gave way to newer ones, as the daemon was held up"},
    Meaning{"camera", "untimed",
            "frames whose time of capture could not be told: over 0.5 s late, or the first ones, until five "
            "agree on its clock, for 5 s at most"},
    Meaning{"camera", "repeated",
            "frames that were not used, as each, or at least half of it, equals one to the last bit that "
            "came over "
            "0.5 s before it, and more than five have equalled earlier ones since: the camera hangs, or its "
            "lens is "
            "covered"},
    Meaning{
        "camera", "opened",
        "how often it was opened; over once: it was gone, fell silent, showed one image again and again, or "
        "all its frames came late"},
    Meaning{"camera", "is_off",
            "one error of its pose or depth explains what several sensors contradict, clearly more than an "
            "offset of a joint does, and no sensor is named meanwhile; null: its images are not compared "
            "with ranges"},
    Meaning{
        "camera", "turned_deg",
        "then, and with joint_states.or_camera, about how far it is turned against the rig, about its axes: "
        "x right, y down, z ahead; null: it is not off"},
    Meaning{"camera", "shifted_m", "or shifted along them; null: it is not off"},
    Meaning{"camera", "depth_scale", "or the true depth by that of its image; null: it is not off"},
    Meaning{"camera", "explains_sensors", "of how many sensors that explains the contradictions"},
    Meaning{"camera", "age_s", "since its newest frame came; null: none yet"},
    Meaning{"latency", "readings", "how many the figures are of"},
    Meaning{"latency", "median_ms",
            "from the kernel's stamp of the frame that completed a reading (its own, the joint state behind "
            "it, or one that made that certain) to the map: half of them were as quick"},
    Meaning{"latency", "p99_ms", "99 of 100 were as quick"},
    Meaning{"latency", "max_ms", "the slowest"},
    Meaning{"latency", "age_median_ms",
            "from the middle of the time in which a reading was taken to the map, whatever it waited for: "
            "half of them were as young"},
    Meaning{"latency", "age_p99_ms", "99 of 100 were as young"},
    Meaning{"latency", "age_max_ms", "the oldest"},
    Meaning{"map", "known_voxels", "voxels that are free or occupied"},
    Meaning{"map", "resolution_m", "the edge of a voxel"},
    Meaning{"map", "memory_mib", "what they take in memory"},
    Meaning{"map", "memory_max_mib", "the mapping's limit"},
    Meaning{"map", "no_room",
            "updates refused, as the map had reached memory_max_mib and the space was new to it: raise it, "
            "or use a larger resolution_m"},
    Meaning{"map", "no_memory",
            "updates refused, as the system had no memory and the space was new to it: lower memory_max_mib, "
            "or give the service more"},
    Meaning{"map", "undated",
            "updates that went in without their time, for which there was no room or memory: how old such a "
            "voxel is nobody knows, so that it is stale and never forgotten. As with no_room and no_memory"},
    Meaning{"map", "saved", "how often it was saved"},
    Meaning{"map", "saves_failed", "saves that failed; problems has why"},
    Meaning{"map", "saves_skipped", "saves left out, as the one before was still being written: a slow disk"},
    Meaning{"map", "saved_age_s", "since the newest good save; null: none yet"},
    Meaning{"map", "folder_silent_s",
            "for how long the maps' folder has not answered a save or a look at it; null: it answers"},
    Meaning{"reloads", "count", "how often SIGHUP brought new settings"},
    Meaning{"reloads", "unchanged", "how often SIGHUP found the files as they were: nothing changed then"},
    Meaning{
        "reloads", "dropped",
        "readings, joint samples and depth frames that waited at a reload and could not be used any more"},
    Meaning{"reloads", "reading_s", "for how long SIGHUP's files are being read; null: they are not"},
    Meaning{"log", "dropped", "lines left out, as what reads the log took none for too long"},
    Meaning{"log", "waiting", "lines that are not written yet"},
    Meaning{"log", "stuck_s", "for how long one line is being written; null: none is"},
    Meaning{"account", "in", "what came"},
    Meaning{"account", "used", "what went into the map, or was taken in"},
    Meaning{"account", "pending", "what waits, for a joint state or for others to arrive"},
    Meaning{"account", "rejected", "the counters that are not 0, by name: account.md has each"},
    Meaning{"account", "balanced",
            "in = used + pending + the sum of rejected; if not, it is a defect of octoskin"},
};

}  // namespace

std::span<const Meaning> status_meanings() noexcept {
    return kStatusMeanings;
}

}  // namespace octoskin

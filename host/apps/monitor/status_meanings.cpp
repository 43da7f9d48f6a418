#include "host/apps/monitor/status_meanings.hpp"

#include <array>

namespace octoskin {
namespace {

constexpr ValueType kNumber{ValueKind::number};
constexpr ValueType kNumberOrNull{ValueKind::number, true};
constexpr ValueType kInteger{ValueKind::integer};
constexpr ValueType kIntegerOrNull{ValueKind::integer, true};
constexpr ValueType kCount{ValueKind::count};
constexpr ValueType kCountOrNull{ValueKind::count, true};
constexpr ValueType kFlag{ValueKind::flag};
constexpr ValueType kFlagOrNull{ValueKind::flag, true};
constexpr ValueType kWord{ValueKind::word};
constexpr ValueType kWordOrNull{ValueKind::word, true};
constexpr ValueType kText{ValueKind::text};
constexpr ValueType kTextOrNull{ValueKind::text, true};
constexpr ValueType kList{ValueKind::list};
constexpr ValueType kListOrNull{ValueKind::list, true};
constexpr ValueType kTable{ValueKind::table};
constexpr ValueType kTableOrNull{ValueKind::table, true};

// The tables of docs/status.md. Tests check that they are equal to these, and that these have each value of a
// daemon's status with its type.
constexpr std::array kStatusMeanings = {
    Meaning{"", "octoskin", kText, "", "program, version and commit"},
    Meaning{"", "uptime_s", kNumber, "s", "since the daemon started"},
    Meaning{"", "rig", kText, "", "the name of the rig"},
    Meaning{"", "links_without_body", kList, "",
            "moving links with a <visual> that no body covers, neither their own nor that of a link fixed to "
            "them: they are not removed from images and ranges"},
    Meaning{"", "links_unknown", kList, "",
            "those of links_without_body that the rig's robot.links_without_body does not list: while there "
            "is one, a query answers unknown instead of free"},
    Meaning{"", "links_with_borrowed_body", kTable, "",
            "moving links with a <visual> and no body of their own, each with the fixed neighbour whose body "
            "is used for it"},
    Meaning{
        "", "problems", kList, "",
        "one table for each problem, below, the most fundamental first; if the map is empty, the reason is "
        "among them"},
    Meaning{"", "can", kTable, "", "the CAN interface, below"},
    Meaning{"", "clock", kTable, "", "the bus time, below"},
    Meaning{"", "nodes", kList, "", "one table for each node of the rig, below"},
    Meaning{"", "joint_states", kTable, "",
            "whether joint states come from one sender and whether they are right, below"},
    Meaning{"", "joints_socket", kTableOrNull, "",
            "joint states from this machine, below; null without --joints"},
    Meaning{"", "recording", kTableOrNull, "",
            "the current or the last recording, below; null: there was none"},
    Meaning{"", "cameras", kList, "", "the depth cameras in the rig's order, below; empty without one"},
    Meaning{"", "latency", kTable, "",
            "how late readings reach the map: after the frame that completed them, and after their capture, "
            "below"},
    Meaning{"", "map", kTable, "", "the fused map, below"},
    Meaning{"", "reloads", kTable, "", "re-reads of rig, robot and mapping, below"},
    Meaning{"", "watch", kTable, "", "the clients of [`watch`](reference/watch.md), below"},
    Meaning{"", "log", kTable, "", "the daemon's log on its way to standard error, below"},
    Meaning{"", "inputs", kTable, "",
            "the input counters: one table for each of \"CAN frames\", \"readings\", \"joint samples\" and "
            "\"depth frames\" (of several cameras \"depth frames of NAME\"), below; they count since the "
            "newest reload"},
    Meaning{"problems", "code", kWord, "", "the kind of problem, for programs to compare"},
    Meaning{"problems", "text", kText, "", "a sentence for people; it may change"},
    Meaning{"problems", "on", kText, "",
            "what has the problem: a node, a sensor, the camera, an interface; absent: the daemon itself or "
            "the bus"},
    Meaning{"problems", "key", kText, "",
            "the counter of the status or the configuration key that it is about; absent if there is none"},
    Meaning{"problems", "remedy", kText, "",
            "what to do; absent if the text has none, or has it with the cause"},
    Meaning{"can", "interface", kText, "", "the name of the interface"},
    Meaning{"can", "state", kWord, "", "up, error_passive, bus_off, down or absent: the worst that applies"},
    Meaning{"can", "why", kText, "", "why it is not up, with the remedy; empty if it is up"},
    Meaning{"can", "listen_only", kFlag, "", "the daemon transmits nothing (--listen-only)"},
    Meaning{"can", "received", kCount, "", "frames received, the echoes of the daemon's own included"},
    Meaning{"can", "sent", kCount, "",
            "frames handed to the interface: two a second, SYNC and FOLLOW_UP, and two more when the time "
            "comes into doubt; 0 with --listen-only"},
    Meaning{"can", "not_sent", kCount, "",
            "frames that the interface did not accept, because it was not up or its queue was full: they are "
            "not sent later, and if this continues the nodes lose the time"},
    Meaning{
        "can", "foreign_follow_ups", kCount, "",
        "FOLLOW_UP frames of other hosts, ignored because they would set another time; 0 with --listen-only"},
    Meaning{"can", "busy_s", kNumber, "s",
            "how long this rig's frames kept the bus busy, in the worst case; its growth in a second is the "
            "bus load. Other frames are not counted: the kernel filters them out"},
    Meaning{"can", "error_frames", kCount, "",
            "error reports of the adapter: a wrong bit rate or sample point, a missing terminator, a "
            "disturbed line, or no node that acknowledges. A few when something is plugged in are usual"},
    Meaning{"can", "dropped_by_kernel", kCount, "",
            "frames that the kernel dropped, because the daemon was held up for too long to read them"},
    Meaning{
        "can", "malformed", kCount, "",
        "input from the interface that is no CAN frame: a driver's defect, or a foreign program behind fd:N"},
    Meaning{"can", "bus_off", kCount, "",
            "how often the adapter left the bus after too many errors of its own"},
    Meaning{"can", "went_down", kCount, "", "how often the interface went down"},
    Meaning{"can", "reopened", kCount, "",
            "how often the interface was opened again: it had been removed, as when an adapter is unplugged, "
            "or its filters could not be changed at a reload"},
    Meaning{"clock", "known", kFlag, "", "the bus time is known; without it no input from the bus is used"},
    Meaning{"clock", "steps_back", kCount, "",
            "how often the receive time stamps, which are wall time, jumped back: the clock of this machine "
            "was set. The next exchange of SYNC and FOLLOW_UP resolves it"},
    Meaning{"clock", "steps_ahead", kCount, "",
            "how often the time stamps jumped ahead by over 0.14 s: the clock was set, or the bus was silent "
            "for that long"},
    Meaning{"clock", "stamps_ignored", kCount, "",
            "receive time stamps that jumped alone, without others that agreed: from other interfaces in one "
            "log, or a driver's error"},
    Meaning{
        "clock", "relocks", kCount, "",
        "how often two exchanges agreed on a new offset between wall time and the bus time, as after a step"},
    Meaning{"clock", "times_back", kCount, "",
            "how often the bus time itself went back by over 0.15 s: the host that sends SYNC restarted"},
    Meaning{"clock", "times_ahead", kCount, "",
            "how often the bus time went ahead by over a second more than passed: another host sends SYNC, "
            "or the host's clock was set. The age of the map does not change"},
    Meaning{"clock", "follow_up_outliers", kCount, "",
            "exchanges that disagreed with the known clock of the other host (with --listen-only); the first "
            "ones after it was set are among them"},
    Meaning{"nodes", "id", kInteger, "", "its node id"},
    Meaning{"nodes", "name", kText, "", "its name in the rig"},
    Meaning{"nodes", "verdict", kWord, "",
            "usable, or why not: other_version, quarantined, babbling, absent, lost, time_suspect, "
            "info_incomplete, info_mismatch, build_refused"},
    Meaning{"nodes", "reason", kTextOrNull, "",
            "of info_mismatch and the like: what the node reports and what the rig has; else null"},
    Meaning{"nodes", "state", kWordOrNull, "",
            "its state in its newest heartbeat; the fault table has each with its remedy; null before the "
            "first"},
    Meaning{"nodes", "age_s", kNumberOrNull, "s",
            "since it was heard; null: never, or the time is not known"},
    Meaning{"nodes", "degraded_sensors", kCountOrNull, "",
            "those of its sensors that are not well, by its newest heartbeat"},
    Meaning{"nodes", "clock_known", kFlag, "", "its readings can be given a time now"},
    Meaning{"nodes", "clock_ppm", kNumberOrNull, "ppm",
            "seconds of bus time per second of its own clock, less 1: negative if its clock is fast. Beyond "
            "250 either way its readings are refused as clock_in_doubt; null: not known"},
    Meaning{"nodes", "clock_error_ms", kNumberOrNull, "ms",
            "bound on the error of its time now; it grows with silence; null: not known"},
    Meaning{"nodes", "refused_share", kNumberOrNull, "",
            "share of its readings within the last second that were refused for their time, number or "
            "sender; null: 0.05 or less"},
    Meaning{"nodes", "refused_most", kWordOrNull, "",
            "the most frequent reason for these, a name of counters.md; null as refused_share"},
    Meaning{"nodes", "clock_contradictions", kCount, "",
            "answers to SYNC under its id that contradicted another answer to the same SYNC "
            "(sync_contradicted): there is another sender"},
    Meaning{"nodes", "restarts", kCount, "",
            "how often it restarted, by its own heartbeat; many: check its supply, its watchdog, and for "
            "another sender"},
    Meaning{"nodes", "registers", kList, "",
            "one table for each register that reads back another value than was written, below; empty if "
            "there is none"},
    Meaning{"nodes", "sensors", kList, "", "one table for each sensor, below"},
    Meaning{"nodes.registers", "register", kInteger, "", "its index, 0 to 255"},
    Meaning{"nodes.registers", "written", kInteger, "", "the value written to it"},
    Meaning{"nodes.registers", "read", kInteger, "", "the value read back"},
    Meaning{"nodes.registers", "alike", kFlag, "",
            "three or more sensors of the node read back this value: this part type behaves so, and no "
            "reading is withheld for it"},
    Meaning{"nodes.registers", "sensor", kIntegerOrNull, "",
            "the number on the node of the sensor that reads back this value; null if alike"},
    Meaning{"nodes.registers", "sensors", kCount, "",
            "sensors that had read back this value when the node reported it"},
    Meaning{"nodes.sensors", "index", kInteger, "", "its number on the node"},
    Meaning{"nodes.sensors", "name", kText, "", "its name in the rig"},
    Meaning{"nodes.sensors", "state", kWordOrNull, "",
            "its state in the node's newest SENSOR_HEALTH; null: not known, because none came yet, or "
            "neither that nor a reading for 3 s"},
    Meaning{
        "nodes.sensors", "fault", kWordOrNull, "",
        "why it is not well, by the same message; the fault table has each with its remedy; null: not known"},
    Meaning{"nodes.sensors", "received", kCount, "", "readings that arrived"},
    Meaning{"nodes.sensors", "lost", kCount, "",
            "readings that its node sent and that never arrived, exact as of the newest SENSOR_HEALTH"},
    Meaning{"nodes.sensors", "age_s", kNumberOrNull, "s",
            "since its newest reading arrived; null: none yet, or the time is not known"},
    Meaning{"nodes.sensors", "range_m", kNumber, "m",
            "range of its newest reading, as the sensor gives it: a distance only if device_status is 9. "
            "With a status such as 4, no target, it is noise; absent before the first"},
    Meaning{"nodes.sensors", "sigma_m", kNumber, "m",
            "the standard deviation that the sensor gives for its newest range; absent before the first"},
    Meaning{"nodes.sensors", "device_status", kInteger, "",
            "the sensor's own status of that range: 9 is valid, protocol.md has the others; absent before "
            "the first"},
    Meaning{"nodes.sensors", "zone", kInteger, "", "the zone in which it measured; absent before the first"},
    Meaning{"nodes.sensors", "rejected", kWordOrNull, "",
            "why the newest reading was not used, a name of counters.md; null: it was used, or it waits"},
    Meaning{"nodes.sensors", "contradictions", kCount, "",
            "readings that cannot come from the sender of the earlier ones: their number arrived with other "
            "contents, or goes back while their time does not (contradicts_reading). A single one may be a "
            "damaged frame"},
    Meaning{"nodes.sensors", "strays", kCount, "",
            "readings refused for their time or number that arrived between two consecutive readings of the "
            "sensor: damaged frames, or another sender's"},
    Meaning{"nodes.sensors", "second_sender", kFlag, "",
            "another sender uses its name: it is disputed, or two strays came within 2.5 s"},
    Meaning{"nodes.sensors", "disputed", kFlag, "",
            "its readings stay out of the map (sensor_disputed): two contradictions came within a second, or "
            "over a quarter as many strays as it has readings, and the last of them is under a second old"},
    Meaning{"nodes.sensors", "reflexes", kCount, "",
            "how often it sent REFLEX: something came closer than reflex_below_m"},
    Meaning{"nodes.sensors", "reflex_below_m", kNumber, "m", "its limit in the rig; 0: none"},
    Meaning{"nodes.sensors", "reflex_m", kNumberOrNull, "m",
            "the distance at the newest REFLEX; null: none yet"},
    Meaning{
        "nodes.sensors", "camera", kTableOrNull, "",
        "the cross-check of its ranges against the cameras, below: that with the strongest evidence; null "
        "without a camera"},
    Meaning{"nodes.sensors.camera", "of", kText, "", "name of the camera; empty for a rig's only one"},
    Meaning{"nodes.sensors.camera", "verdict", kWord, "",
            "agrees: each fault that would have changed its ranges has enough evidence against it; "
            "contradicts; or cannot_tell: doubt has why"},
    Meaning{"nodes.sensors.camera", "contradicts", kFlag, "",
            "it contradicts the camera: swapped with another, stuck, or not where the rig has it"},
    Meaning{"nodes.sensors.camera", "fault", kWordOrNull, "",
            "the fault that its ranges match: ranges_too_long, ranges_too_short, often_short, turned or "
            "exchanged; null: none of these"},
    Meaning{"nodes.sensors.camera", "doubt", kWordOrNull, "",
            "why it is cannot_tell. too_few_comparisons: a fault would not have shown yet. ambiguous: too "
            "little evidence for a fault and too little against it. camera_not_known: the other sensors do "
            "not show well enough where the camera is. camera_is_off: the camera is off, or likely so. "
            "joint_is_off: a joint is, with or without the camera, or likely so. several_contradict: more "
            "than two sensors contradict the camera. cameras_disagree: it contradicts one camera and agrees "
            "with another. null: another verdict"},
    Meaning{"nodes.sensors.camera", "not_excluded", kList, "",
            "the faults that the comparisons do not exclude; turned and exchanged are in it until each turn "
            "and each exchange is excluded, also those that would not have changed a range"},
    Meaning{"nodes.sensors.camera", "refused", kFlag, "",
            "its readings stay out of the map (contradicts_camera): it contradicts the camera, no fewer "
            "others agree with the camera, and the mapping refuses such sensors"},
    Meaning{"nodes.sensors.camera", "compared", kCount, "",
            "ranges for which the camera predicted a surface"},
    Meaning{"nodes.sensors.camera", "fitted", kCount, "",
            "those of them close to the predicted range: within a few centimetres, or up to 12 cm before a "
            "surface that the camera sees from behind. A sensor that contradicts the camera can fit"},
    Meaning{"nodes.sensors.camera", "agreed", kCount, "",
            "comparisons in which the sensor saw a surface where the camera sees one"},
    Meaning{"nodes.sensors.camera", "in_free_space", kCount, "",
            "comparisons in which the sensor saw a surface where the camera sees free space"},
    Meaning{"nodes.sensors.camera", "behind_surface", kCount, "",
            "comparisons in which the sensor saw free space through a surface that the camera sees"},
    Meaning{"joint_states", "sources", kList, "",
            "one table for each source of joint states of the rig, below"},
    Meaning{"joint_states.sources", "node_id", kInteger, "", "its node"},
    Meaning{"joint_states.sources", "via", kWord, "", "can or socket"},
    Meaning{"joint_states.sources", "rate_hz", kNumber, "Hz", "its rate in the rig"},
    Meaning{"joint_states.sources", "age_s", kNumberOrNull, "s",
            "since its newest sample that is used; null: none yet"},
    Meaning{"joint_states.sources", "joints", kList, "", "one table for each of its joints, below"},
    Meaning{"joint_states.sources.joints", "name", kText, "", "as in the URDF"},
    Meaning{"joint_states.sources.joints", "poses_without", kCount, "",
            "poses of the robot, for a reading or an image, at whose time its position was not known, but "
            "that of other joints was"},
    Meaning{"joint_states", "second_sender", kFlag, "",
            "two senders are active, or were within the last second: neither is used"},
    Meaning{"joint_states", "contradictions", kCount, "",
            "how often two senders under one joint node of the bus contradicted each other"},
    Meaning{"joint_states", "jumped", kTextOrNull, "",
            "the joint that last moved further between two samples than the arm can in that time; null: none "
            "yet"},
    Meaning{"joint_states", "jump_age_s", kNumberOrNull, "s",
            "since such a sample was rejected; null: none yet"},
    Meaning{"joint_states", "off_joint", kTextOrNull, "",
            "the joint whose offset explains the contradictions of several sensors; meanwhile no sensor is "
            "named; null: none"},
    Meaning{"joint_states", "off_by", kNumberOrNull, "rad or m",
            "its estimated offset, of a prismatic joint in metres; null: none is off"},
    Meaning{
        "joint_states", "or_camera", kFlag, "",
        "an error of the camera explains about as many contradictions: which of the two is off is not known"},
    Meaning{"joints_socket", "samples", kCount, "", "samples received, of the right form"},
    Meaning{"joints_socket", "displaced", kCount, "",
            "datagrams displaced by newer ones: the daemon was held up while 1024 waited, or they come "
            "faster than it takes them beside the bus"},
    Meaning{"joints_socket", "surplus", kCount, "",
            "datagrams dropped on arrival: beyond 2048 a second of one program, or of a ninth program while "
            "eight send samples. The samples of the others are taken"},
    Meaning{"joints_socket", "thinned", kCount, "",
            "samples left out because they followed the one before sooner than the rig's rate: usual for a "
            "fast driver"},
    Meaning{
        "joints_socket", "second_sender", kCount, "",
        "samples left out because more than one program sends some of their source, or did within the last "
        "second"},
    Meaning{"joints_socket", "rate_hz", kNumber, "Hz", "samples received within the newest second"},
    Meaning{"joints_socket", "above_rate", kFlag, "",
            "samples of a source come at over 1.3 times its rate_hz of the rig: the surplus is thinned"},
    Meaning{
        "joints_socket", "joint_node_ignored", kCount, "",
        "frames on the bus of joint nodes whose joint states come through the socket, which are not used"},
    Meaning{"joints_socket", "not_a_number", kCount, "",
            "refused: a word that is no finite number, or a comma without a number on each side"},
    Meaning{"joints_socket", "wrong_count", kCount, "",
            "refused: neither as many numbers as the rig has joints, nor one more, the time; by name: a part "
            "of a source, or none"},
    Meaning{"joints_socket", "time_off", kCount, "",
            "refused: its time differs by over 1 s from when it was read, or it has none and waited longer "
            "than that. Send CLOCK_MONOTONIC of this machine in seconds; the usual cause is wall time"},
    Meaning{"joints_socket", "too_large", kCount, "",
            "refused: a position beyond +-8.38 rad (or m); the usual cause is degrees"},
    Meaning{"joints_socket", "too_long", kCount, "", "refused: over 4096 bytes"},
    Meaning{"joints_socket", "senders", kList, "",
            "one table for each program and source that it sent within the last second, below; a source with "
            "more than one program is not used"},
    Meaning{"joints_socket.senders", "node_id", kInteger, "", "the node of the source that it sends"},
    Meaning{"joints_socket.senders", "pid", kInteger, "",
            "its process; 0: not visible from here, as in another container; all of those count as one"},
    Meaning{"joints_socket.senders", "uid", kInteger, "", "its user; 0 if the process is not visible"},
    Meaning{"joints_socket.senders", "program", kText, "", "its name; empty: not known"},
    Meaning{"joints_socket.senders", "address", kText, "",
            "the address that its socket is bound to; empty: none"},
    Meaning{"joints_socket.senders", "samples", kCount, "", "samples received from it"},
    Meaning{"joints_socket.senders", "age_s", kNumber, "s", "since the newest of them"},
    Meaning{"recording", "state", kWord, "", "recording, finishing, ended or failed"},
    Meaning{"recording", "folder", kText, "", "the folder that it is written to"},
    Meaning{"recording", "error", kText, "", "why it failed; empty if it has not"},
    Meaning{"recording", "seconds", kNumber, "s", "its length"},
    Meaning{"recording", "can_frames", kCount, "", "bus frames in it"},
    Meaning{"recording", "depth_frames", kCount, "", "depth frames in it"},
    Meaning{"recording", "commits", kCount, "",
            "joint samples, readings and depth frames that went into the map during it"},
    Meaning{"recording", "lost_can", kCount, "",
            "bus frames that the disk could not take in time: they change no voxel of a replay"},
    Meaning{"recording", "lost_commits", kCount, "",
            "measurements that the disk could not take in time, or for which the system lacked memory here "
            "or in the map: a replay gives another map"},
    Meaning{"recording", "lost_depth", kCount, "",
            "depth frames that the disk could not take in time, for which the system lacked memory here or "
            "in the map, or with depth beyond 32.767 m: a replay gives another map"},
    Meaning{"recording", "is_complete", kFlag, "", "it lacks nothing that went into the map"},
    Meaning{"recording", "ended_early", kText, "",
            "why it ended before its time and without a request: the bus time jumped, the daemon re-read its "
            "files or ended; else empty"},
    Meaning{"cameras", "name", kText, "", "in the rig; empty for its only camera"},
    Meaning{"cameras", "link", kText, "", "the link that carries it; empty: it is beside the robot"},
    Meaning{"cameras", "device", kText, "",
            "OpenNI2 URI, .oni file, or ros: and a topic: a program feeds it; empty: the first device"},
    Meaning{"cameras", "open", kFlag, "", "it is open"},
    Meaning{"cameras", "why", kText, "", "why it is not; empty if it is"},
    Meaning{"cameras", "frames", kCount, "", "frames received"},
    Meaning{"cameras", "displaced", kCount, "",
            "frames displaced by newer ones, because the daemon was held up"},
    Meaning{"cameras", "untimed", kCount, "",
            "frames without a known capture time: over 0.5 s late, or the first ones, until five agree on "
            "the camera's clock, for 5 s at most; of a camera that a program feeds also those over 0.05 s "
            "ahead"},
    Meaning{"cameras", "repeated", kCount, "",
            "frames not used because all of the image, or at least half of it, equals bit by bit one from "
            "over 0.5 s before, and more than five have equalled earlier ones since: the camera hangs, or "
            "its lens is covered"},
    Meaning{"cameras", "opened", kCount, "",
            "how often it was opened; more than once: it was gone, fell silent, showed one image again and "
            "again, or all its frames came late"},
    Meaning{"cameras", "is_off", kFlagOrNull, "",
            "one error of its pose or depth explains the contradictions of several sensors, clearly more "
            "than an offset of a joint does; meanwhile no sensor is named; null: its images are not compared "
            "with ranges"},
    Meaning{"cameras", "turned_deg", kListOrNull, "deg",
            "if it is off, or with joint_states.or_camera: its estimated rotation against the rig, about its "
            "axes x right, y down, z ahead; null: it is not off"},
    Meaning{"cameras", "shifted_m", kListOrNull, "m",
            "or its estimated shift along them; null: it is not off"},
    Meaning{"cameras", "depth_scale", kNumberOrNull, "",
            "or the true depth divided by the depth of its image; null: it is not off"},
    Meaning{"cameras", "explains_sensors", kCount, "", "sensors whose contradictions this explains"},
    Meaning{"cameras", "age_s", kNumberOrNull, "s", "since its newest frame arrived; null: none yet"},
    Meaning{"watch", "watchers", kCount, "", "clients of `watch`, at most 8"},
    Meaning{"watch", "stalled", kCount, "", "how many were dropped because they read nothing for 30 s"},
    Meaning{"watch", "lost", kCount, "",
            "ranges, joint samples and status that no watcher got, because too many waited or there was no "
            "memory"},
    Meaning{"latency", "readings", kCount, "", "readings that the figures cover"},
    Meaning{"latency", "median_ms", kNumber, "ms",
            "from the kernel's time stamp of the frame that completed a reading (its own, the joint state "
            "after it, or one that made that certain) to the map: half of them took no longer"},
    Meaning{"latency", "p99_ms", kNumber, "ms", "99 of 100 took no longer"},
    Meaning{"latency", "max_ms", kNumber, "ms", "the slowest"},
    Meaning{"latency", "age_median_ms", kNumber, "ms",
            "from the middle of a reading's measurement to the map, all waiting included: half of them were "
            "no older"},
    Meaning{"latency", "age_p99_ms", kNumber, "ms", "99 of 100 were no older"},
    Meaning{"latency", "age_max_ms", kNumber, "ms", "the oldest"},
    Meaning{"map", "known_voxels", kCount, "",
            "voxels that are free or occupied now, without those that have expired"},
    Meaning{"map", "resolution_m", kNumber, "m", "the edge of a voxel"},
    Meaning{"map", "memory_mib", kNumber, "MiB", "memory that the map takes"},
    Meaning{"map", "memory_max_mib", kInteger, "MiB", "the limit in the mapping"},
    Meaning{"map", "no_room", kCount, "",
            "updates refused because the map had reached memory_max_mib and the space was new to it: raise "
            "it, or use a larger resolution_m"},
    Meaning{"map", "no_memory", kCount, "",
            "updates refused because the system had no memory and the space was new to the map: lower "
            "memory_max_mib, or give the service more"},
    Meaning{"map", "undated", kCount, "",
            "updates stored without their time, because there was no room or memory for it: the age of such "
            "a voxel is not known, so it is stale and never expires. Remedy as for no_room and no_memory"},
    Meaning{"map", "saved", kCount, "", "how often it was saved"},
    Meaning{"map", "saves_failed", kCount, "", "saves that failed; problems has why"},
    Meaning{"map", "saves_skipped", kCount, "",
            "saves left out because the one before was still being written: a slow disk"},
    Meaning{"map", "saved_age_s", kNumberOrNull, "s", "since the newest successful save; null: none yet"},
    Meaning{"map", "folder_silent_s", kNumberOrNull, "s",
            "for how long the maps' folder has not answered a save or a check; null: it answers"},
    Meaning{"reloads", "count", kCount, "", "how often SIGHUP brought new settings"},
    Meaning{"reloads", "unchanged", kCount, "", "how often SIGHUP found the files unchanged"},
    Meaning{"reloads", "dropped", kCount, "",
            "readings, joint samples and depth frames that waited at a reload and could no longer be used"},
    Meaning{"reloads", "reading_s", kNumberOrNull, "s",
            "time since the reading of the files after SIGHUP began; null: they are not being read"},
    Meaning{"log", "dropped", kCount, "",
            "lines dropped because the reader of the log took none for too long"},
    Meaning{"log", "waiting", kCount, "", "lines not written yet"},
    Meaning{"log", "stuck_s", kNumberOrNull, "s",
            "for how long a line has been waiting to be written; null: none is"},
    Meaning{"inputs", "in", kCount, "", "inputs of this kind"},
    Meaning{"inputs", "used", kCount, "", "inputs that went into the map, or were accepted"},
    Meaning{"inputs", "pending", kCount, "", "inputs that wait, for a joint state or for others to arrive"},
    Meaning{"inputs", "rejected", kTable, "", "the counters that are not 0, by name: counters.md has each"},
    Meaning{"inputs", "balanced", kFlag, "",
            "in = used + pending + the sum of rejected; if not, it is a defect of octoskin"},
};

}  // namespace

std::span<const Meaning> status_meanings() noexcept {
    return kStatusMeanings;
}

}  // namespace octoskin

#include "firmware/port/stm32g4/can_controller.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "firmware/core/transmit_places.hpp"
#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/pin.hpp"
#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"
#include "firmware/port/stm32g4/registers/fdcan.hpp"

namespace octoskin::stm32g4 {

namespace {

using F = Field<FdcanMap>;

constexpr Pin kReceivePin{gpio_a, 11};
constexpr Pin kTransmitPin{gpio_a, 12};
constexpr std::uint8_t kFunction = 9;  // datasheet DS12288, alternate functions

constexpr std::uint32_t kInterrupts =
    F("IE.RF0NE")(1) | F("IE.RF0LE")(1) | F("IE.TCE")(1) | F("IE.MRAFE")(1) | F("IE.EPE")(1) | F("IE.BOE")(1);
constexpr std::uint32_t kAccept = 0;  // RXGFC.ANFS: into FIFO 0
constexpr std::uint32_t kReject = 2;  // RXGFC.ANFS, ANFE
static_assert(kFifoElements == node::kTransmitPlaces);
constexpr std::uint32_t kAllPlaces = (1U << kFifoElements) - 1;
constexpr Microseconds kModeLimit{1'000};  // the controller responds within a few of its clocks

/// Exceeded only if more than three new frames arrive during one interrupt.
constexpr std::uint32_t kFramesPerInterrupt = 2 * kFifoElements;

CanElement read_element(Address address) {
    CanElement element{};
    element[0] = load(address);
    element[1] = load(address + 4);
    const std::uint32_t words = words_in_use(decode_element(element).payload_len);
    for (std::uint32_t i = 2; i < words; ++i) element[i] = load(address + 4 * i);
    return element;
}

}  // namespace

bool CanController::start(const CanRates& rates, wire::NodeId node_id, std::uint32_t clock_hz) {
    is_started_ = enter(rates, node_id, clock_hz) && set_init(false);
    return is_started_;
}

bool CanController::listen(const CanRates& rates, wire::NodeId node_id, std::uint32_t clock_hz) {
    is_started_ = false;
    heard_ = 0;
    has_errors_ = false;
    if (!enter(rates, node_id, clock_hz)) return false;
    listen_to_all();
    is_listening_ = set_init(false);
    return is_listening_;
}

/// Configures the controller and leaves it in INIT.
bool CanController::enter(const CanRates& rates, wire::NodeId node_id, std::uint32_t clock_hz) {
    is_listening_ = false;
    if (clock_hz == 0 || !is_possible(rates, clock_hz)) return false;
    rcc.set("APB1ENR1.FDCANEN", 1);
    (void)rcc.read("APB1ENR1");
    if (!set_init(true)) return false;
    give_up_all();
    fdcan1.set("CCCR.CCE", 1);
    fdcan1.set("CCCR.ASM", 0);
    fdcan1.set("CCCR.MON", 0);
    has_lost_ram_ = false;
    set_timing(rates, clock_hz);
    prepare(node_id);
    kReceivePin.make_alternate(kFunction, Drive::push_pull);
    kTransmitPin.make_alternate(kFunction, Drive::push_pull, Speed::high);
    cpu::enable(Interrupt::fdcan1_it0, cpu::Priority::stamp);
    return true;
}

void CanController::set_timing(const CanRates& rates, std::uint32_t clock_hz) const {
    fdcan1.write("CKDIV", 0);
    if (const auto nominal = nominal_timing(clock_hz, rates.nominal)) fdcan1.write("NBTP", nbtp(*nominal));
    const auto data = data_timing(clock_hz, rates.data);
    if (!rates.has_fd || !data) return;
    fdcan1.write("DBTP", dbtp(rates.data, *data));
    fdcan1.write("TDCR", tdcr(*data));
    fdcan1.set("CCCR.FDOE", 1);
    fdcan1.set("CCCR.BRSE", 1);
}

/// Bus monitoring mode: the controller sends recessive bits only, so it neither acknowledges nor sends error
/// frames.
void CanController::listen_to_all() const {
    fdcan1.set("CCCR.MON", 1);
    fdcan1.set("RXGFC.ANFS", kAccept);
    fdcan1.write("IE", fdcan1.read("IE") | F("IE.PEAE")(1) | F("IE.PEDE")(1));
}

bool CanController::join() {
    const bool was_listening = std::exchange(is_listening_, false);
    if (!was_listening || !set_init(true)) return false;
    fdcan1.set("CCCR.CCE", 1);
    fdcan1.set("CCCR.MON", 0);
    fdcan1.set("RXGFC.ANFS", kReject);
    fdcan1.write("IE", kInterrupts);
    is_started_ = set_init(false);
    return is_started_;
}

Heard CanController::heard() const {
    return {.frames = heard_, .has_errors = has_errors_};
}

void CanController::prepare(wire::NodeId node_id) const {
    for (std::uint32_t i = 0; i < kMessageRamBytes; i += 4) store(kMessageRam + i, 0);
    std::uint32_t index = 0;
    for (const std::uint32_t filter : node_filters(node_id)) store(kStandardFilters + 4 * index++, filter);
    // Remote frames with an identifier of this node pass, so that the node can count them.
    fdcan1.write("RXGFC", F("RXGFC.RRFE")(1) | F("RXGFC.ANFE")(kReject) | F("RXGFC.ANFS")(kReject) |
                              F("RXGFC.LSS")(kFilterCount));
    fdcan1.write("TXBC", F("TXBC.TFQM")(1));  // the lowest identifier first
    fdcan1.write("TXBTIE", F("TXBTIE.TIE")(kAllPlaces));
    fdcan1.write("IE", kInterrupts);
    fdcan1.write("ILS", 0);
    fdcan1.write("ILE", F("ILE.EINT0")(1));
}

/// The bit shows its new value only after the controller has responded; until then it must not be written
/// again.
bool CanController::set_init(bool is_set) const {
    fdcan1.set("CCCR.INIT", is_set ? 1 : 0);
    const NodeTime begun = timer_.now();
    while (fdcan1.is_set("CCCR.INIT") != is_set) {
        if (elapsed(begun, timer_.now()) > kModeLimit) return false;
    }
    return true;
}

bool CanController::has_room_for(const wire::CanFrame& frame) const {
    std::array<std::uint32_t, kFifoElements> waiting{};
    std::size_t count = 0;
    for (const Place& place : places_) {
        if (place.is_pending) waiting[count++] = place.frame.can_id;
    }
    return node::may_join(std::span(waiting).first(count), frame.can_id);
}

bool CanController::send(const wire::CanFrame& frame) {
    if (!is_started_ || fdcan1.is_set("PSR.BO") || fdcan1.is_set("TXFQS.TFQF")) return false;
    const std::uint32_t index = fdcan1.get("TXFQS.TFQPI");
    if (index >= kFifoElements) return false;
    note_ended();
    if (places_[index].is_given_up || !has_room_for(frame)) return false;
    const CanElement element = encode_element(frame);
    const Address address = element_address(kTransmitFifo, index);
    const std::uint32_t words = words_in_use(frame.payload_len);
    for (std::uint32_t i = 0; i < words; ++i) store(address + 4 * i, element[i]);
    places_[index] = {.frame = frame, .given = timer_.now(), .is_pending = true};
    fdcan1.write("TXBAR", 1U << index);
    return true;
}

std::optional<ReceivedFrame> CanController::receive() {
    if (!has_received()) return std::nullopt;
    const ReceivedFrame oldest = queue_[taken_ % kQueueFrames];
    taken_ = taken_ + 1;
    return oldest;
}

node::CanState CanController::state() const {
    if (!is_started_) return node::CanState::passive;
    const std::uint32_t status = fdcan1.read("PSR");
    if (F("PSR.BO").of(status) != 0) return node::CanState::bus_off;
    return F("PSR.EP").of(status) != 0 || failed_at_ ? node::CanState::passive : node::CanState::active;
}

/// Transmit requests survive bus-off: a frame that is not cancelled would be sent late.
void CanController::discard() {
    if (!is_started_) return;
    note_ended();
    for (std::uint32_t i = 0; i < kFifoElements; ++i) take_back(i);
}

/// The hardware sets INIT on bus-off and never clears it itself.
void CanController::restart() {
    if (state() == node::CanState::bus_off && fdcan1.is_set("CCCR.INIT")) fdcan1.set("CCCR.INIT", 0);
}

/// A request ends when its frame was sent or cancelled. A frame that was on the wire when it was cancelled
/// may still have been sent: then both TXBTO and TXBCF are set. So TXBTO decides. It must be read after
/// TXBRP, or it could show an earlier state.
void CanController::note_ended() {
    const bool is_any_pending =
        std::any_of(places_.begin(), places_.end(), [](const Place& place) { return place.is_pending; });
    if (!is_any_pending) return;
    const std::uint32_t requests = fdcan1.get("TXBRP.TRP");
    const std::uint32_t sent = fdcan1.get("TXBTO.TO");
    for (std::uint32_t i = 0; i < kFifoElements; ++i) {
        Place& place = places_[i];
        if (!place.is_pending || ((requests >> i) & 1U) != 0) continue;
        place.is_pending = false;
        place.is_given_up = ((sent >> i) & 1U) == 0;
        if (place.is_given_up) ++counts_.given_up;
    }
}

/// Setting CCE clears every request.
void CanController::give_up_all() {
    note_ended();
    for (Place& place : places_) {
        if (!place.is_pending) continue;
        place.is_pending = false;
        place.is_given_up = true;
        ++counts_.given_up;
    }
}

/// RM0440, MRAF: the message RAM did not answer in time. The controller then restricts itself (ASM): it
/// acknowledges, but sends nothing. INIT without bus-off means another failure. CCCR is read before PSR,
/// since bus-off sets INIT together with PSR.BO.
bool CanController::has_failed() const {
    const std::uint32_t mode = fdcan1.read("CCCR");
    const bool is_off = F("CCCR.INIT").of(mode) != 0 && !fdcan1.is_set("PSR.BO");
    return has_lost_ram_ || F("CCCR.ASM").of(mode) != 0 || is_off;
}

void CanController::fall_silent(NodeTime now) {
    fdcan1.set("CCCR.INIT", 1);
    give_up_all();
    is_started_ = false;
    failed_at_ = now;
    ++counts_.failed;
}

void CanController::take_back(std::uint32_t index) {
    Place& place = places_[index];
    if (!place.is_pending || place.is_taken_back) return;
    place.is_taken_back = true;
    fdcan1.write("TXBCR", 1U << index);
}

std::optional<wire::CanFrame> CanController::take_given_up() {
    if (is_started_) note_ended();
    for (Place& place : places_) {
        if (!place.is_given_up) continue;
        place.is_given_up = false;
        return place.frame;
    }
    return std::nullopt;
}

void CanController::poll(NodeTime now) {
    if (failed_at_ && elapsed(*failed_at_, now) >= kFailureShown) failed_at_.reset();
    if (!is_started_) return;
    if (has_failed()) return fall_silent(now);
    note_ended();
    for (std::uint32_t i = 0; i < kFifoElements; ++i) {
        if (elapsed(places_[i].given, now) >= kTransmitAgeMax) take_back(i);
    }
}

std::optional<NodeTime> CanController::wake_time() const {
    std::optional<NodeTime> wake;
    for (const Place& place : places_) {
        if (!place.is_pending || place.is_taken_back) continue;
        const NodeTime expires = place.given + kTransmitAgeMax;
        if (!wake || is_reached(expires, *wake)) wake = expires;
    }
    return wake;
}

CanCounts CanController::counts() const {
    CanCounts counts = counts_;
    counts.received = put_;
    counts.receive_lost = lost_;
    return counts;
}

void CanController::on_interrupt() {
    const NodeTime now = timer_.now();
    const std::uint32_t flags = fdcan1.read("IR");
    fdcan1.write("IR", flags);
    if (F("IR.RF0L").of(flags) != 0) lost_ = lost_ + 1;
    if (F("IR.MRAF").of(flags) != 0) has_lost_ram_ = true;
    if (F("IR.PEA").of(flags) != 0 || F("IR.PED").of(flags) != 0) has_errors_ = true;
    receive_all(now);
    has_event_ = true;
}

void CanController::receive_all(NodeTime now) {
    for (std::uint32_t i = 0; i < kFramesPerInterrupt && fdcan1.get("RXF0S.F0FL") > 0; ++i) {
        const std::uint32_t index = fdcan1.get("RXF0S.F0GI");
        heard_ = heard_ + 1;
        const bool has_room = put_ - taken_ < kQueueFrames;
        if (has_room) {
            const CanElement element = read_element(element_address(kReceiveFifo, index));
            queue_[put_ % kQueueFrames] = {.frame = decode_element(element), .received = now};
            put_ = put_ + 1;
        } else {
            lost_ = lost_ + 1;
        }
        fdcan1.write("RXF0A", F("RXF0A.F0AI")(index));
    }
}

}  // namespace octoskin::stm32g4

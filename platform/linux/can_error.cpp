#include "platform/linux/can_error.hpp"

#include <linux/can/error.h>

namespace crspf {
namespace {

#ifndef CAN_ERR_CNT
constexpr std::uint32_t CAN_ERR_CNT = 0x200;  // NOLINT(readability-identifier-naming): newer kernels' headers have it
#endif

CanState state_of(std::uint8_t transmit_errors, std::uint8_t receive_errors) {
    const std::uint8_t worst = transmit_errors > receive_errors ? transmit_errors : receive_errors;
    return worst >= 128 ? CanState::kPassive : worst >= 96 ? CanState::kWarning : CanState::kActive;
}

}  // namespace

void note_can_error(const CanFrame& frame, CanHealth& health) {
    if (!frame.error) {
        return;
    }
    const auto has = [&](std::uint32_t kind) { return (frame.id & kind) != 0; };
    if (has(CAN_ERR_CNT)) {
        health.transmit_errors = frame.data[6];
        health.receive_errors = frame.data[7];
        if (health.state != CanState::kBusOff) {
            health.state = state_of(frame.data[6], frame.data[7]);
        }
    }
    if (has(CAN_ERR_CRTL)) {
        const std::uint8_t what = frame.data[1];
        health.overflows += (what & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0 ? 1U : 0U;
        if ((what & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
            health.state = CanState::kPassive;
        } else if ((what & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
            health.state = CanState::kWarning;
        } else if ((what & CAN_ERR_CRTL_ACTIVE) != 0) {
            health.state = CanState::kActive;
        }
    }
    health.bus_errors += has(CAN_ERR_PROT | CAN_ERR_TRX | CAN_ERR_ACK | CAN_ERR_BUSERROR) ? 1U : 0U;
    if (has(CAN_ERR_RESTARTED)) {
        ++health.restarts;
        health.state = CanState::kActive;
    }
    if (has(CAN_ERR_BUSOFF)) {
        ++health.bus_offs;
        health.state = CanState::kBusOff;
    }
}

}  // namespace crspf

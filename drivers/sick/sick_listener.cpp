#include "drivers/sick/sick_listener.hpp"

namespace crspf {

void SickListener::on_open() {
    parser_.reset();
    sequence_.reset();
}

std::optional<SickTiming> SickListener::on_telegram(const ColaTelegram& telegram, Stamp received) {
    if (!telegram.is("sSN", "LMDscandata")) {
        return std::nullopt;
    }
    if (!decode_lmd_scandata(telegram, data_)) {
        ++undecodable_;
        return std::nullopt;
    }
    ++decoded_;
    return sequence_.accept(data_, received);
}

}  // namespace crspf

// SHA-256, to name files and results by their content.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace crspf {

class Sha256 {
 public:
    Sha256();
    Sha256(const Sha256&) = delete;
    Sha256& operator=(const Sha256&) = delete;
    Sha256(Sha256&&) = delete;
    Sha256& operator=(Sha256&&) = delete;
    ~Sha256();

    void update(std::span<const std::byte> bytes);

    /// 64 lower-case digits of all that was given since the start or the last hex(); starts anew.
    [[nodiscard]] std::string hex();

 private:
    struct State;  // keeps nettle out of the header
    std::unique_ptr<State> state_;
};

}  // namespace crspf

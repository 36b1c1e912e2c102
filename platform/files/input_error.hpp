// The one exception of the tools: something outside the program is wrong, and the message says what to do about it.
#pragma once

#include <stdexcept>
#include <string>

namespace crspf {

/// what() reads "FILE:LINE: reason; remedy", ready to print.
class InputError : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

}  // namespace crspf

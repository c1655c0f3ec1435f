// The errors that reach users. Every layer throws these; the bindings turn them into ValueError and SceneError.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace octomarch {

/// A parameter outside its domain; the message names the argument and the value. Python: ValueError.
class ArgumentError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// A valid graph that cannot be compiled (too many registers, for instance). Python: octomarch.SceneError.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Long work stopped on request: the host's interrupt check said so. Python: the pending exception, else KeyboardInterrupt.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

/// Throws ArgumentError "<argument> must be <requirement>, got <value>" unless `valid`.
template <class Value>
void require(bool valid, std::string_view argument, std::string_view requirement, const Value& value) {
  if (valid) return;
  std::ostringstream message;
  message << argument << " must be " << requirement << ", got " << value;
  throw ArgumentError(message.str());
}

}  // namespace octomarch

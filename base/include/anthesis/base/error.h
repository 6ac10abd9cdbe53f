#pragma once
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace anthesis {

/// What kind of thing went wrong, for programs to act on. `exit_code` says what the command line answers.
enum class ErrorCode {
  kInvalidParameter,  ///< a value that breaks its rule
  kUnknownParameter,  ///< a key, flag or name that does not exist
  kParse,             ///< text that is not what its format allows
  kIo,                ///< reading or writing failed
  kTooLarge,          ///< input or result beyond a stated limit
  kCrossing,          ///< surfaces cross that must not
  kCancelled,         ///< the progress callback asked to stop
};

/// An error is a value: a code to act on, a place to look, a sentence with the rule and the value.
struct Error {
  ErrorCode code = ErrorCode::kInvalidParameter;
  std::string where;    ///< "head.divergence_deg"; readers put "daisy.toml:14:9: " in front. May be empty.
  std::string message;  ///< "must be > 0, got -0.4"
};

/// Result or error; spelled like C++23's std::expected.
template <class T>
using Expected = tl::expected<T, Error>;

using tl::unexpected;

/// kInvalidParameter for the field `where`: "<rule>, got <value>".
Error invalid_parameter(std::string_view where, std::string_view rule, double value);
Error invalid_parameter(std::string_view where, std::string_view rule, std::string_view value);

/// "<where> <message>", or "<message>" alone.
std::string to_string(const Error& error);

/// The process exit status for an error: 65 for bad data, 74 for input/output, 2 for usage, 1 for crossings,
/// 130 for a cancelled run.
int exit_code(ErrorCode code);

/// Shortest text that reads back as the same double, with a point whatever the locale.
std::string to_text(double value);

/// The element of `names` nearest to `name` in edits, if near enough to be a slip of the keyboard, else empty.
std::string_view nearest_name(std::string_view name, const std::string_view* names, std::size_t count);

}  // namespace anthesis

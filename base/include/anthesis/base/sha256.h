#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace anthesis {

/// SHA-256 of `bytes`, as 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);

/// The same of bytes that come piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();

  void add(std::string_view bytes);

  /// Of all that was added. Call once, last.
  std::string digits();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace anthesis

#pragma once
#include <numbers>

/// Transcendental functions with the same bits on every x86-64 processor. The C library's differ between processors
/// with and without fused multiply-add. Within 1 unit in the last place; sqrt of <cmath> is exact everywhere as it is.
namespace anthesis::math {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTurnRad = 2.0 * std::numbers::pi;

constexpr double radians(double degrees) {
  return degrees * (kPi / 180.0);
}
constexpr double degrees(double radians) {
  return radians * (180.0 / kPi);
}

struct SinCos {
  double sin;
  double cos;
};

double sin(double angle_rad);
double cos(double angle_rad);
SinCos sin_cos(double angle_rad);  ///< both for little more than the price of one
double tan(double angle_rad);
double asin(double x);
double acos(double x);
double atan2(double y, double x);
double exp(double x);
double log(double x);
double pow(double x, double y);

/// The largest of 1, 2, 5 times a power of ten that is not above `value`: lengths of scale bars, steps of axes.
/// Precondition: `value` finite and > 0 (asserted).
double round_down_to_125(double value);

/// The smallest of them that is not below `value`, but for a billionth of it: a value that is one of them up to
/// rounding stays. Precondition: as above.
double round_up_to_125(double value);

}  // namespace anthesis::math

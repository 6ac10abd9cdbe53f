#include "anthesis/base/math.h"

#include <sleef.h>

#include <cmath>
#include <initializer_list>

#include "anthesis/base/assert.h"

// The "purec" functions of SLEEF without FMA ("cinz") are plain C: nothing is chosen by the processor at run time.
namespace anthesis::math {
namespace {

/// By multiplication, so that powers of ten come out as they are written.
double power_of_ten_below(double value) {
  ANTHESIS_ASSERT(std::isfinite(value) && value > 0.0);
  double power = 1.0;
  while (power > value) {
    power /= 10.0;
  }
  while (10.0 * power <= value) {
    power *= 10.0;
  }
  return power;
}

}  // namespace

double sin(double angle_rad) {
  return Sleef_cinz_sind1_u10purec(angle_rad);
}
double cos(double angle_rad) {
  return Sleef_cinz_cosd1_u10purec(angle_rad);
}
SinCos sin_cos(double angle_rad) {
  const auto both = Sleef_cinz_sincosd1_u10purec(angle_rad);
  return {both.x, both.y};
}
double tan(double angle_rad) {
  return Sleef_cinz_tand1_u10purec(angle_rad);
}
double asin(double x) {
  return Sleef_cinz_asind1_u10purec(x);
}
double acos(double x) {
  return Sleef_cinz_acosd1_u10purec(x);
}
double atan2(double y, double x) {
  return Sleef_cinz_atan2d1_u10purec(y, x);
}
double exp(double x) {
  return Sleef_cinz_expd1_u10purec(x);
}
double log(double x) {
  return Sleef_cinz_logd1_u10purec(x);
}
double pow(double x, double y) {
  return Sleef_cinz_powd1_u10purec(x, y);
}

double round_down_to_125(double value) {
  const double power = power_of_ten_below(value);
  return value >= 5.0 * power ? 5.0 * power : value >= 2.0 * power ? 2.0 * power : power;
}
double round_up_to_125(double value) {
  const double power = power_of_ten_below(value);
  const double least = value * (1.0 - 1e-9);
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) {
      return factor * power;
    }
  }
  return 10.0 * power;
}

}  // namespace anthesis::math

#include "anthesis/base/math.h"

#include <sleef.h>

// The "purec" functions of SLEEF without FMA ("cinz") are plain C: nothing is chosen by the processor at run time.
namespace anthesis::math {

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

}  // namespace anthesis::math

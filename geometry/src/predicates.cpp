#include "anthesis/geometry/predicates.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "anthesis/base/assert.h"

namespace anthesis {
namespace {

// Half a unit in the last place of 1.
constexpr double kRounding = 0x1p-53;

// As PlaneSide::kRelativeError and kUnderflow, for the determinant in two dimensions.
constexpr double kRelativeError2d = (3.0 + 16.0 * kRounding) * kRounding;
constexpr double kUnderflow2d = 1e-320;

/// A whole number of any size that the determinants below can reach: sign and magnitude, least digit first.
///
/// Expansions (sums of doubles that do not overlap) would be the usual choice. Whole numbers in units of the smallest
/// bit among the coordinates are as short in code, need no care for underflow, and are of one digit each for the
/// coordinates that matter here: those that single precision holds.
class Whole {
 public:
  Whole() = default;

  /// value / 2^exponent, which is a whole number.
  Whole(double value, int exponent) {
    int own_exponent = 0;
    const double fraction = std::frexp(std::fabs(value), &own_exponent);
    if (fraction == 0.0) {
      return;
    }
    negative_ = value < 0.0;
    auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    int shift = own_exponent - 53 - exponent;
    if (shift < 0) {
      mantissa >>= -shift;  // zeros only
      shift = 0;
    }
    const int digit = shift / 64;
    const int bit = shift % 64;
    std::fill_n(digits_.begin(), digit, 0);
    digits_[digit] = mantissa << bit;
    digits_[digit + 1] = bit == 0 ? 0 : mantissa >> (64 - bit);
    size_ = digit + 2;
    trim();
  }

  int sign() const { return size_ == 0 ? 0 : negative_ ? -1 : 1; }

  friend Whole operator-(const Whole& a, const Whole& b) { return sum(a, b, !b.negative_); }
  friend Whole operator+(const Whole& a, const Whole& b) { return sum(a, b, b.negative_); }

  friend Whole operator*(const Whole& a, const Whole& b) {
    Whole product;
    if (a.size_ == 0 || b.size_ == 0) {
      return product;
    }
    product.size_ = a.size_ + b.size_;
    product.negative_ = a.negative_ != b.negative_;
    std::fill_n(product.digits_.begin(), product.size_, 0);
    for (int i = 0; i < a.size_; ++i) {
      std::uint64_t carry = 0;
      for (int j = 0; j < b.size_; ++j) {
        const DoubleDigit t = DoubleDigit{a.digits_[i]} * b.digits_[j] + product.digits_[i + j] + carry;
        product.digits_[i + j] = static_cast<std::uint64_t>(t);
        carry = static_cast<std::uint64_t>(t >> 64);
      }
      product.digits_[i + b.size_] = carry;
    }
    product.trim();
    return product;
  }

 private:
  __extension__ using DoubleDigit = unsigned __int128;

  // Coordinates have less than 1075 + 333 bits, so differences have at most 23 digits, their products 46, and sums of
  // products of three 70.
  static constexpr int kMostDigits = 72;

  void trim() {
    while (size_ > 0 && digits_[size_ - 1] == 0) {
      --size_;
    }
  }

  static bool magnitude_less(const Whole& a, const Whole& b) {
    if (a.size_ != b.size_) {
      return a.size_ < b.size_;
    }
    for (int i = a.size_ - 1; i >= 0; --i) {
      if (a.digits_[i] != b.digits_[i]) {
        return a.digits_[i] < b.digits_[i];
      }
    }
    return false;
  }

  /// a + b, with b's sign replaced.
  static Whole sum(const Whole& a, const Whole& b, bool b_negative) {
    Whole result;
    if (a.negative_ == b_negative) {
      const Whole& longer = a.size_ >= b.size_ ? a : b;
      const Whole& shorter = a.size_ >= b.size_ ? b : a;
      std::uint64_t carry = 0;
      for (int i = 0; i < longer.size_; ++i) {
        const DoubleDigit t =
            DoubleDigit{longer.digits_[i]} + (i < shorter.size_ ? shorter.digits_[i] : std::uint64_t{0}) + carry;
        result.digits_[i] = static_cast<std::uint64_t>(t);
        carry = static_cast<std::uint64_t>(t >> 64);
      }
      result.digits_[longer.size_] = carry;
      result.size_ = longer.size_ + 1;
      result.negative_ = a.negative_;
    } else {
      const bool swap = magnitude_less(a, b);
      const Whole& larger = swap ? b : a;
      const Whole& smaller = swap ? a : b;
      std::uint64_t borrow = 0;
      for (int i = 0; i < larger.size_; ++i) {
        const DoubleDigit take = DoubleDigit{i < smaller.size_ ? smaller.digits_[i] : std::uint64_t{0}} + borrow;
        const DoubleDigit have = larger.digits_[i];
        result.digits_[i] = static_cast<std::uint64_t>(have - take);
        borrow = have < take ? 1 : 0;
      }
      result.size_ = larger.size_;
      result.negative_ = swap ? b_negative : a.negative_;
    }
    result.trim();
    return result;
  }

  int size_ = 0;
  bool negative_ = false;
  std::array<std::uint64_t, kMostDigits> digits_;  // set below size_ only: clearing all would take most of the time
};

/// The exponent of the lowest bit that is set in any of the values.
int lowest_bit(std::span<const double> values) {
  int lowest = 0x7fff;
  for (const double value : values) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
    const int exponent = static_cast<int>((bits >> 52) & 0x7ff);
    const std::uint64_t mantissa = exponent == 0 ? fraction : fraction | (std::uint64_t{1} << 52);
    if (mantissa != 0) {
      lowest = std::min(lowest, std::max(exponent, 1) - 1075 + std::countr_zero(mantissa));
    }
  }
  return lowest;
}

template <std::size_t kCount>
[[maybe_unused]] bool within_limit(const std::array<double, kCount>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::fabs(v) <= kPredicateLimit; });
}

[[gnu::noinline]] int exact_orient2d(Vec2 a, Vec2 b, Vec2 c) {
  const std::array<double, 6> values = {a.x, a.y, b.x, b.y, c.x, c.y};
  ANTHESIS_ASSERT(within_limit(values));
  const int unit = lowest_bit(values);
  const Whole ax(a.x, unit);
  const Whole ay(a.y, unit);
  return ((Whole(b.x, unit) - ax) * (Whole(c.y, unit) - ay) - (Whole(b.y, unit) - ay) * (Whole(c.x, unit) - ax)).sign();
}

[[gnu::noinline]] int exact_orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const std::array<double, 12> values = {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z};
  ANTHESIS_ASSERT(within_limit(values));
  const int unit = lowest_bit(values);
  struct Arrow {
    Whole x, y, z;
  };
  const auto arrow = [&](Vec3 to) {
    return Arrow{Whole(to.x, unit) - Whole(a.x, unit), Whole(to.y, unit) - Whole(a.y, unit),
                 Whole(to.z, unit) - Whole(a.z, unit)};
  };
  const Arrow ab = arrow(b);
  const Arrow ac = arrow(c);
  const Arrow ad = arrow(d);
  return (ab.x * (ac.y * ad.z - ac.z * ad.y) + ab.y * (ac.z * ad.x - ac.x * ad.z) + ab.z * (ac.x * ad.y - ac.y * ad.x))
      .sign();
}

}  // namespace

int orient2d(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (b.x - a.x) * (c.y - a.y);
  const double right = (b.y - a.y) * (c.x - a.x);
  const double determinant = left - right;
  const double bound = kRelativeError2d * (std::fabs(left) + std::fabs(right)) + kUnderflow2d;
  if (std::fabs(determinant) > bound) {
    return determinant > 0.0 ? 1 : -1;
  }
  return exact_orient2d(a, b, c);
}

std::optional<std::array<std::size_t, 2>> crossing_pieces(std::span<const Vec2> line, bool closed) {
  const std::size_t count = line.size();
  const std::size_t pieces = closed ? count : count - std::min<std::size_t>(count, 1);
  const auto point = [&](std::size_t i) { return line[i % count]; };
  for (std::size_t i = 0; i < pieces; ++i) {
    const Vec2 a = point(i);
    const Vec2 b = point(i + 1);
    if (closed || i + 1 < pieces) {
      const Vec2 next = point(i + 2);
      if (orient2d(a, b, next) == 0 && dot(next - b, a - b) >= 0.0) {
        return {{i, (i + 1) % count}};
      }
    }
    for (std::size_t j = i + 2; j < pieces - (closed && i == 0 ? 1 : 0); ++j) {
      const Vec2 c = point(j);
      const Vec2 d = point(j + 1);
      if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
          std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y)) {
        continue;
      }
      if (orient2d(a, b, c) * orient2d(a, b, d) <= 0 && orient2d(c, d, a) * orient2d(c, d, b) <= 0) {
        return {{i, j}};
      }
    }
  }
  return std::nullopt;
}

int orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ad = d - a;
  const double yz = ac.y * ad.z;
  const double zy = ac.z * ad.y;
  const double zx = ac.z * ad.x;
  const double xz = ac.x * ad.z;
  const double xy = ac.x * ad.y;
  const double yx = ac.y * ad.x;
  const double determinant = ab.x * (yz - zy) + ab.y * (zx - xz) + ab.z * (xy - yx);
  const double positive = std::fabs(ab.x) * (std::fabs(yz) + std::fabs(zy)) +
                          std::fabs(ab.y) * (std::fabs(zx) + std::fabs(xz)) +
                          std::fabs(ab.z) * (std::fabs(xy) + std::fabs(yx));
  if (std::fabs(determinant) > PlaneSide::kRelativeError * positive + PlaneSide::kUnderflow) {
    return determinant > 0.0 ? 1 : -1;
  }
  return exact_orient3d(a, b, c, d);
}

}  // namespace anthesis

#pragma once
#include <algorithm>
#include <cmath>
#include <optional>

#include "float_math.h"

namespace anthesis {

/// How a thin sheet scatters light, seen from one direction. See docs/rendering.md for the formulas.
///
/// On the seen side: an even (Lambert) part and a rough clear reflection; on the other side an even part of what passes
/// through. Directions are in the frame of the surface, +z to the seen side. No direction of view returns more than it
/// receives.
class Bsdf {
 public:
  struct Look {
    Vec3f colour;
    float roughness = 0.6F;
    float specular = 0.0F;
    float sheen = 0.0F;
    float translucency = 0.0F;
  };

  struct Sample {
    Vec3f direction;
    Vec3f weight;  ///< value * cos / density
  };

  Bsdf(const Look& look, Vec3f to_eye) : eye_(to_eye) {
    eye_.z = std::max(eye_.z, 1e-3F);
    alpha_ = std::max(0.03F, look.roughness * look.roughness);
    f0_ = 0.08F * look.specular;
    const float grazing = pow5(1.0F - std::min(eye_.z, 1.0F));
    // Share of the light that the clear layer takes, and what is left for the pigment below.
    f90_ = look.specular > 0.0F ? std::max(f0_, 0.5F * look.specular * (1.0F - look.roughness)) : 0.0F;
    const float clear = f0_ + (f90_ - f0_) * grazing;
    const float edge = 1.0F - std::min(eye_.z, 1.0F);
    const float velvet = 0.5F * look.sheen * edge * edge * edge;
    const Vec3f colour = look.colour;
    const float strongest = max_channel(colour);
    // Fine hairs scatter light of the petal's colour, half washed out.
    const Vec3f hair = 0.5F * colour + Vec3f(0.5F * strongest);
    reflected_ = (1.0F - clear) * ((1.0F - velvet) * (1.0F - look.translucency) * colour + velvet * hair);
    // What comes out behind has met the pigment once more on its way: the strongest channel passes as it is, the others
    // give way. A white sheet stays white.
    Vec3f through = colour;
    if (strongest > 0.0F) {
      const float k = 1.0F / strongest;
      through = {colour.x * std::sqrt(colour.x * k), colour.y * std::sqrt(colour.y * k),
                 colour.z * std::sqrt(colour.z * k)};
    }
    transmitted_ = ((1.0F - clear) * (1.0F - velvet) * look.translucency) * through;

    const float even = luminance(reflected_) + 0.3F * max_channel(reflected_);
    const float behind = luminance(transmitted_) + 0.3F * max_channel(transmitted_);
    const float total = even + behind + clear;
    if (total > 0.0F) {
      even_share_ = even / total;
      behind_share_ = behind / total;
      clear_share_ = 1.0F - even_share_ - behind_share_;
      if (f0_ <= 0.0F) {
        clear_share_ = 0.0F;
      }
    }
  }

  /// Value of the function, without the cosine.
  Vec3f value(Vec3f to_light) const {
    if (to_light.z <= 0.0F) {
      return (1.0F / kPiF) * transmitted_;
    }
    return (1.0F / kPiF) * reflected_ + Vec3f(clear(to_light));
  }

  /// A direction of density about value * cos; nothing when the path ends here. u chooses the part.
  std::optional<Sample> sample(float u, float x, float y) const {
    if (u < behind_share_) {
      Vec3f direction = cosine_direction(x, y);
      direction.z = -direction.z;
      return Sample{direction, (1.0F / behind_share_) * transmitted_};
    }
    Vec3f direction;
    if (u < behind_share_ + even_share_) {
      direction = cosine_direction(x, y);
    } else if (clear_share_ > 0.0F) {
      const Vec3f half = visible_facet(x, y);
      direction = 2.0F * dot(eye_, half) * half - eye_;
    } else {
      return std::nullopt;
    }
    if (direction.z <= 1e-6F) {
      return std::nullopt;
    }
    float density = even_share_ * direction.z * (1.0F / kPiF);
    if (clear_share_ > 0.0F) {
      density += clear_share_ * clear_density(direction);
    }
    return Sample{direction, (direction.z / density) * value(direction)};
  }

  Vec3f reflected() const { return reflected_; }
  Vec3f transmitted() const { return transmitted_; }
  float clear_share() const { return clear_share_; }

 private:
  /// GGX with Smith's masking and Schlick's Fresnel term.
  float clear(Vec3f to_light) const {
    if (f0_ <= 0.0F) {
      return 0.0F;
    }
    const Vec3f half = normalized(to_light + eye_);
    const float fresnel = f0_ + (f90_ - f0_) * pow5(1.0F - std::clamp(dot(eye_, half), 0.0F, 1.0F));
    const float a2 = alpha_ * alpha_;
    const float masking = 0.5F / (to_light.z * slope(eye_.z) + eye_.z * slope(to_light.z));
    return facets(half.z, a2) * masking * fresnel;
  }
  float clear_density(Vec3f to_light) const {
    const Vec3f half = normalized(to_light + eye_);
    const float a2 = alpha_ * alpha_;
    return facets(half.z, a2) * 0.5F / (eye_.z + slope(eye_.z));
  }
  static float facets(float cosine, float a2) {
    const float d = cosine * cosine * (a2 - 1.0F) + 1.0F;
    return a2 / (kPiF * d * d);
  }
  float slope(float cosine) const {
    const float a2 = alpha_ * alpha_;
    return std::sqrt(a2 + (1.0F - a2) * cosine * cosine);
  }

  /// A facet with the density of those the eye sees (Heitz 2018).
  Vec3f visible_facet(float u, float v) const {
    const Vec3f stretched = normalized(Vec3f(alpha_ * eye_.x, alpha_ * eye_.y, eye_.z));
    const float across = stretched.x * stretched.x + stretched.y * stretched.y;
    const Vec3f t1 =
        across > 0.0F ? (1.0F / std::sqrt(across)) * Vec3f(-stretched.y, stretched.x, 0.0F) : Vec3f(1.0F, 0.0F, 0.0F);
    const Vec3f t2 = cross(stretched, t1);
    const DiscPoint d = disc_from_square(u, v);
    const float s = 0.5F * (1.0F + stretched.z);
    const float y = (1.0F - s) * std::sqrt(std::max(0.0F, 1.0F - d.x * d.x)) + s * d.y;
    const Vec3f n = d.x * t1 + y * t2 + std::sqrt(std::max(0.0F, 1.0F - d.x * d.x - y * y)) * stretched;
    return normalized(Vec3f(alpha_ * n.x, alpha_ * n.y, std::max(1e-6F, n.z)));
  }

  Vec3f eye_;
  Vec3f reflected_;
  Vec3f transmitted_;
  float alpha_ = 0.1F;
  float f0_ = 0.0F;
  float f90_ = 0.0F;
  float even_share_ = 0.0F;
  float behind_share_ = 0.0F;
  float clear_share_ = 0.0F;
};

}  // namespace anthesis

// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDShading_h
#define FFDShading_h

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <vector>

namespace ffd
{

/// A light in the space of Shading; its colors include the intensity.
struct Light
{
  bool Headlight = false;  ///< shines along the viewing ray
  bool Positional = false; ///< at Position, else from infinity
  glm::dvec3 Position{ 0.0 };
  glm::dvec3 Towards{ 0.0, 0.0, 1.0 }; ///< unit vector from the scene to a light at infinity
  glm::dvec3 Axis{ 0.0, 0.0, -1.0 };   ///< unit vector along which a spot light shines
  glm::vec3 Ambient{ 0.0f };
  glm::vec3 Diffuse{ 1.0f };
  glm::vec3 Specular{ 1.0f };
  glm::dvec3 Attenuation{ 1.0, 0.0, 0.0 }; ///< constant, linear, quadratic
  double ConeCosine = -2.0;                ///< below -1: no cone
  double ConeExponent = 1.0;

  bool operator==(const Light& other) const
  {
    return this->Headlight == other.Headlight && this->Positional == other.Positional &&
      this->Position == other.Position && this->Towards == other.Towards &&
      this->Axis == other.Axis && this->Ambient == other.Ambient &&
      this->Diffuse == other.Diffuse && this->Specular == other.Specular &&
      this->Attenuation == other.Attenuation && this->ConeCosine == other.ConeCosine &&
      this->ConeExponent == other.ConeExponent;
  }
};

/// Reflectance of a material: factors of the ambient, diffuse and Blinn-Phong specular terms.
struct Reflectance
{
  float Ambient = 0.1f;
  float Diffuse = 0.7f;
  float Specular = 0.2f;
  float SpecularPower = 10.0f;
};

/**
 * Material of the volume and the lights on it. Rays are cast in data coordinates; lights shine in a
 * space of their own, so that a volume whose matrix does not scale all axes alike is lit as the
 * deformed shape that it has in the world.
 */
struct Shading : Reflectance
{
  bool TwoSided = true;
  std::vector<Light> Lights;

  /// Takes positions and directions, data coordinates, to the space of the lights.
  void SetToLights(const glm::dmat3& toLights)
  {
    this->ToLights = toLights;
    this->GradientToLights = glm::transpose(glm::inverse(toLights));
  }
  const glm::dmat3& GetToLights() const { return this->ToLights; }
  /// The same for gradients.
  const glm::dmat3& GetGradientToLights() const { return this->GradientToLights; }

  /**
   * Color of a lit sample, each part at most 1, as VTK's volume mappers have it, in the space of
   * the lights. `normal`: unit vector towards lower scalars, or zero where the scalars are
   * constant; `toEye`: unit vector.
   */
  glm::vec3 Shade(const glm::vec3& color, const glm::dvec3& position, const glm::dvec3& normal,
    const glm::dvec3& toEye) const
  {
    return this->Shade(*this, color, position, normal, toEye);
  }

  /// The same for another material under these lights.
  glm::vec3 Shade(const Reflectance& material, const glm::vec3& color, const glm::dvec3& position,
    const glm::dvec3& normal, const glm::dvec3& toEye) const
  {
    glm::vec3 ambient(0.0f);
    glm::vec3 diffuse(0.0f);
    glm::vec3 specular(0.0f);
    for (const Light& light : this->Lights)
    {
      glm::dvec3 toLight = light.Headlight ? toEye : light.Towards;
      double strength = 1.0;
      if (light.Positional)
      {
        const glm::dvec3 path = light.Position - position;
        const double distance = glm::length(path);
        toLight = distance > 0.0 ? path / distance : toEye;
        strength = LocalStrength(light, toLight, distance);
      }
      ambient += light.Ambient;
      double nDotL = glm::dot(normal, toLight);
      double nDotH = glm::dot(normal, HalfVector(toLight, toEye));
      if (this->TwoSided)
      {
        nDotL = std::abs(nDotL);
        nDotH = std::abs(nDotH);
      }
      if (nDotL > 0.0)
      {
        diffuse += static_cast<float>(strength * nDotL) * light.Diffuse;
      }
      if (nDotH > 0.0)
      {
        specular += static_cast<float>(
                      strength * std::pow(nDotH, static_cast<double>(material.SpecularPower))) *
          light.Specular;
      }
    }
    const glm::vec3 lit = color * (material.Ambient * ambient + material.Diffuse * diffuse) +
      material.Specular * specular;
    return glm::min(lit, 1.0f);
  }

private:
  glm::dmat3 ToLights{ 1.0 };
  glm::dmat3 GradientToLights{ 1.0 };

  static double LocalStrength(const Light& light, const glm::dvec3& toLight, double distance)
  {
    double strength = 1.0 /
      (light.Attenuation.x + light.Attenuation.y * distance +
        light.Attenuation.z * distance * distance);
    if (light.ConeCosine >= -1.0)
    {
      const double cosine = -glm::dot(toLight, light.Axis);
      strength *= cosine >= light.ConeCosine ? std::pow(cosine, light.ConeExponent) : 0.0;
    }
    return strength;
  }

  static glm::dvec3 HalfVector(const glm::dvec3& toLight, const glm::dvec3& toEye)
  {
    const glm::dvec3 sum = toLight + toEye;
    const double length = glm::length(sum);
    return length > 0.0 ? sum / length : glm::dvec3(0.0);
  }
};

} // namespace ffd

#endif

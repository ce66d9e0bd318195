#pragma once

#include <array>
#include <cstddef>

namespace brink {

/// The residual, and its derivatives by the six unknowns of the motion and the constant error of disparities.
inline constexpr std::size_t kEquationColumns = 8;

/// An observation as the normal equations take it.
struct LinearObservation {
  const double* sqrt_information;  ///< 4x4, column by column
  std::array<std::array<double, kEquationColumns>, 4> rows;
  double weight;
};

/// Sums over observations of weight * row^T * row, rows times sqrt_information: the gradient in column 0, the Hessian in the
/// others, of which only the lower triangle is told.
using EquationSums = std::array<std::array<double, kEquationColumns>, kEquationColumns>;

/// Equal to the plain twin in tests/reference/motion_equations.hpp for every target.
/// @return the sums with those of `count` more observations.
EquationSums add_observations(const LinearObservation* observations, std::size_t count, const EquationSums& sums);

}  // namespace brink

#pragma once

#include <Eigen/Core>
#include <optional>

namespace octurn {

/// Cauchy weight of a residual, for iteratively reweighted least squares.
inline double cauchy_weight(double residual, double scale) {
  const double ratio = residual / scale;
  return 1 / (1 + ratio * ratio);
}

/// The solution of normal equations.
struct SymmetricSolution {
  Eigen::VectorXd values = {};
  Eigen::MatrixXd inverse = {};  ///< of the matrix: the covariance, if that was its inverse
};

/// Solves `matrix` x = `right` by Cholesky's decomposition with pivots (LDLT). All solvers share
/// it: for each size of its own, Eigen's takes ten seconds to compile.
/// @param matrix  symmetric, positive semidefinite
/// @return nullopt if it is not, or if x is not finite
std::optional<SymmetricSolution> solve_symmetric(const Eigen::MatrixXd& matrix,
                                                 const Eigen::VectorXd& right);

}  // namespace octurn

#include "solve/symmetric_solver.hpp"

#include <Eigen/Cholesky>

namespace octurn {

std::optional<SymmetricSolution> solve_symmetric(const Eigen::MatrixXd& matrix,
                                                 const Eigen::VectorXd& right) {
  const Eigen::LDLT<Eigen::MatrixXd> factors(matrix);
  SymmetricSolution solution{.values = factors.solve(right)};
  if (factors.info() != Eigen::Success || !factors.isPositive() || !solution.values.allFinite()) {
    return std::nullopt;
  }
  solution.inverse = factors.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  return solution;
}

}  // namespace octurn

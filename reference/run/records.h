// Converts a level's solved instants to the records of a result.
#pragma once

#include "reference/run/options.h"
#include "reference/run/result.h"
#include "reference/run/step_record.h"

#include <Eigen/Core>

#include <vector>

namespace touchstone::reference {

/// Replaces the result's instants, and what it holds per instant beside the uncertainties, by those of one level.
/// @param times_s  of the instants
/// @param shapes   displacement per instant, 3 x rest points
void fill_records(const scene::Scene& scene, const std::vector<double>& times_s, const std::vector<Step>& steps,
                  const std::vector<Eigen::Matrix3Xd>& shapes, Result& result);

}  // namespace touchstone::reference

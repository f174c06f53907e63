// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/session_visits.h"

#include "raven_correction/error.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {

std::vector<Visit> readVisits(const std::string& file, double rest) {
  const Session session = readSessionBag(file);
  std::vector<Visit> visits;
  for (std::size_t i = 0; i < session.goals.size(); ++i) {
    const TrajectoryGoal& goal = session.goals[i];
    if (!goal.has_target) continue;
    visits.push_back(measureVisit(goal.trajectory, goal.target,
                                  session.dataset.trajectories[i].observations, goal.end, rest));
  }
  if (visits.empty())
    throw InvalidInput(
        format("%s: no trajectory_event with a target; record the planner's events", file.c_str()));
  return visits;
}

}  // namespace raven_correction

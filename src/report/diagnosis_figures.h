// SPDX-License-Identifier: BSD-3-Clause
// The figures of a diagnosis: the residual before and after, in the tool and in joints, and what it
// depends on. The page that they stand on is diagnosis_html.cpp.
#pragma once

#include "raven_correction/diagnosis/diagnose.h"
#include "raven_correction/report/figure.h"

namespace raven_correction {

/// Cumulative shares of position and orientation errors, with the noise floor.
Figure errorDistributionFigure(const Verdict& verdict);
/// Quantile strips of the residual per axis of the tool, before beside after.
Figure toolAxesFigure(const Verdict& verdict);
/// The same per joint.
Figure jointAxesFigure(const Verdict& verdict);
/// Share of every cause, with intervals.
Figure causesFigure(const Verdict& verdict);
/// Share of the residual that delay, position, direction, speed, load and time predict.
Figure dependenceFigure(const Verdict& verdict);
/// Error along the motion against speed: the slope is the delay.
Figure delayFigure(const Verdict& verdict);

/// What the error of a joint may be held against.
enum class JointVariable { kPosition, kSpeed, kLoad };
/// Error of every joint against its own position, speed or load, by direction of motion.
Figure jointFigure(const Verdict& verdict, JointVariable variable);

/// The residual over the session.
Figure timeFigure(const Verdict& verdict);
/// Mean error over the workspace, seen from two sides.
Figure workspaceFigure(const Verdict& verdict);
/// Median errors fold by fold.
Figure foldsFigure(const Verdict& verdict);

}  // namespace raven_correction

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <rths/identification/vectors.hpp>

// The constants of the identification: unit, meaning and reason. Those without a source were chosen
// on cases with a known answer. Equal values coincide by accident: each may change alone.

namespace rths::diagnosis {

// ---- Distributions
/// [-] 95 % quantiles of chi-square, from 1 degree of freedom on
inline constexpr std::array kChiSquare95{3.841,  5.991,  7.815,  9.488,
                                         11.070, 12.592, 14.067, 15.507};
inline constexpr double kMedianOfGauss = 0.6745;  ///< [-] of |x|, over the standard deviation
inline constexpr int kResamples = 400;            ///< [-] of a bootstrap
inline constexpr std::size_t kNeighbours = 3;     ///< [blocks] resampled together: they correlate

// ---- Spectra
inline constexpr Index kZeroPadding = 4;  ///< [-] of transforms that look for a sine

// ---- Noise of the sensors
inline constexpr double kFewestAtRest = 100;    ///< [samples] at rest of all records, to be used
inline constexpr double kVarianceOfThird = 20;  ///< [-] of third differences: 1 + 9 + 9 + 1
inline constexpr double kLargestGuess =
    0.03;  ///< [-] of a channel's deviation: a larger guess may be the corners of a coarse path
inline constexpr int kFloorWindow = 256;         ///< [samples] of the spectrum of a channel
inline constexpr std::size_t kFloorWindows = 8;  ///< [windows] that a channel has, at least
inline constexpr std::size_t kLeakageBins = 3;   ///< [bins] that leakage of the window reaches
inline constexpr double kBandsPerOctave = 3;     ///< [-] of the density
inline constexpr double kMostRise = 3;         ///< [-] of the density below the first band, over it
inline constexpr double kBinsOfWindow = 1.5;   ///< [bins] of a Hann window that are one observation
inline constexpr double kChanceOfPower = 6.6;  ///< [-] fall of chi-square by chance, 1 in 100
inline constexpr double kLeastVarianceOfBand =
    0.025;  ///< [-] of log density: polynomials are coarse
// A sine at rest, which is an effect and no noise
inline constexpr std::size_t kLeastStretches = 2;  ///< [stretches] that all have the line
inline constexpr Index kLeastSamplesOfLine = 50;   ///< [samples] fewer fit a sine by chance
inline constexpr double kLeastCycles = 2;  ///< [cycles] in the shortest stretch: fewer may be drift
inline constexpr double kLeastLineShare = 0.25;  ///< [-] of the energy of every stretch
inline constexpr double kBinRoundOff = 1e-9;     ///< [bins] of a number of bins
// Steps of quantisation
inline constexpr double kCoarseStep = 5e-3;  ///< [standard deviations] smallest step that matters
inline constexpr double kRepeats = 0.25;     ///< [-] of the samples of a coarse channel
inline constexpr double kOnSteps = 0.97;     ///< [-] of its changes are whole steps
inline constexpr double kPrintedDigits = 0.02;  ///< [steps] error of samples that were printed

// ---- Noise of the residual
inline constexpr std::size_t kFewDraws = 4;     ///< [draws] where only the level matters
inline constexpr int kResidualOrder = 12;       ///< [-] of its autoregression
inline constexpr double kResidualRidge = 1e-9;  ///< [-] of the variance: filters remove bands of it
inline constexpr double kSmoothingTime = 0.1;   ///< [s] of the deviation over time
inline constexpr double kPieceTime = 3;         ///< [s] shortest piece of one colour,
inline constexpr Index kLeastPiece = 150;       ///< [rows] and at least so many rows
inline constexpr double kLeastErrorShare = 2e-3;      ///< [-] of the output: error of a measurement
inline constexpr std::size_t kDrawsForShrinkage = 4;  ///< [draws] fewer cannot check themselves
inline constexpr std::size_t kDrawsLeftOut = 2;       ///< [draws] at a time: a draw and its reverse
inline constexpr double kFilterRoundOff = 1e-12;      ///< [-] of an output, by filters
inline constexpr Index kAmplitudeSmoothing = 300;     ///< [-] fraction of the frequencies: 1/300
inline constexpr double kLeastAmplitude = 0.03;  ///< [-] of the median: bands that filters removed

// ---- Least squares
inline constexpr int kLongFit = 12;       ///< [iterations] of a fit that is reported
inline constexpr int kShortFit = 5;       ///< [iterations] of a fit that is compared
inline constexpr int kMostAttempts = 10;  ///< [-] at a shorter step
inline constexpr double kFirstDamping = 1e-4, kLeastDamping = 1e-9, kMostDamping = 1e6;  ///< [-]
inline constexpr double kLeastDecrease = 1e-2;  ///< [tolerances] of a step that is worth a run
inline constexpr double kLeastPivot = 1e-12;    ///< [-] of columns of unit length
inline constexpr double kRankCut = 1e-6;        ///< [-] of the largest singular value
inline constexpr double kOwnShare = 1e-7;  ///< [-] of a column that no other explains, at least

// ---- Folds and scores
inline constexpr std::size_t kManyRecords = 4;   ///< [records] at least so many score each other
inline constexpr Index kPieces = 32;             ///< [pieces] of a record that scores itself
inline constexpr double kLongestPiece = 0.125;   ///< [s] less than a peak of strong motion lasts
inline constexpr Index kLeastRowsOfPiece = 8;    ///< [rows] of a longest piece, at any rate
inline constexpr std::size_t kFewPieces = 8;     ///< [pieces] of a stratum: fewer cannot be divided
inline constexpr double kDeterminedShare = 0.2;  ///< [-] of a state's range: determines its law
inline constexpr double kScoreBlock = 1;  ///< [s] of resampling: longer than the noise's memory
/// [-] smallest change of a prediction that counts, over the deviation of the output: integration,
/// filters and sampling may cause as much
inline constexpr double kMaterial = 2e-4;
inline constexpr double kCalibrated =
    5e-3;  ///< [-] the same between two sensors: their calibration

// ---- A round of the selection
inline constexpr double kUnbounded = 1e300;  ///< a parameter without a bound
inline constexpr double kUnknownGain = -1;   ///< that only a fit can show: counts as the best
inline constexpr double kTriedShare = 0.02;  ///< [-] of the best screened gain
inline constexpr double kSameGain = 1e-4;    ///< [-] difference of the gains of equal laws
inline constexpr double kKeptShare = 0.35;   ///< [-] of the gain of the best short fit
/// [-] mean w²: above it, fits also start at stated values, unless the fitted ones are near them
inline constexpr double kFar = 10;
inline constexpr double kReversedShare = 0.5;  ///< [-] of the best gain on the second fold
// An effect on one axis beside the same on all axes
inline constexpr double kShareOfAllAxes = 0.9;  ///< [-] of the gain on all axes
inline constexpr double kShareOfBest = 0.3;     ///< [-] of the best gain
// More noise by one more channel
inline constexpr double kGoodShare = 0.2;      ///< [-] of the best gain: its noise counts
inline constexpr double kMuchMoreNoise = 0.3;  ///< [log] that is allowed for

// ---- Acceptance of a term
inline constexpr std::ptrdiff_t kMostTerms = 4;    ///< [terms] besides hysteresis rules
inline constexpr std::size_t kMostPasses = 3;      ///< [-] over the terms, until none is replaced
inline constexpr double kLeastAcceptedGain = 18;   ///< [nat] over both folds
inline constexpr double kLeastGainOfAnEvent = 90;  ///< [nat] that many resampled records lack
inline constexpr double kCostOfAnEvent = 0.01;     ///< [-] of its gain, elsewhere,
inline constexpr double kScatteredCost = 0.03;     ///< [-] or so much, if the least gain exceeds it
inline constexpr double kAcceptedDensity = 2e-3;   ///< [nat] per observation
inline constexpr double kAcceptedShare = 0.01;     ///< [-] of the excess of the base,
inline constexpr double kMostOfRest = 0.5;   ///< [-] or, if less, of that which other terms leave,
inline constexpr double kAloneOfRest = 0.2;  ///< [-] or of it if no other term gains half as much
inline constexpr double kFormShare = 4e-4;   ///< [-] of a larger term's gain: 2 % error of its form
inline constexpr double kTieShare = 0.01;    ///< [-] of the best gain: smaller differences are ties
inline constexpr double kTieOfRest =
    0.1;  ///< [-] of the energy beyond the noise that the best leaves: as much more is a tie
inline constexpr double kMuchLeft = 0.15;       ///< [-] mean w² beyond 1 that is left to explain
inline constexpr double kLittleOfLeft = 0.2;    ///< [-] of it: a fit may have stalled
inline constexpr double kNoiseVariance = 1.02;  ///< [-] mean w² of noise, without scatter

// ---- Withdrawal of a term
inline constexpr double kLeastGap = 3;  ///< [-] over the deviation of the displacement's noise
inline constexpr double kLeastFlexion = 0.5;  ///< [-] the same, under the largest force
inline constexpr double kWorse = 0.02;        ///< [-] of the error's energy, or noise's, held out
inline constexpr double kLeastShare = 1e-3;   ///< [-] of the error's energy before, held out,
inline constexpr double kFitShare = 0.1;      ///< [-] unless it is this share on the fitted records
inline constexpr double kLeastShareOfCorrection =
    0.05;                                   ///< [-] as kLeastShare, of a form's correction
inline constexpr double kRestShare = 0.5;   ///< [-] of the error that others leave beyond noise
inline constexpr double kSeenShare = 0.25;  ///< [-] of the error's energy: seen in spite of noise
inline constexpr double kLeastShift = 0.1;  ///< [samples] of a shift in time
inline constexpr double kTakenOver = 0.5;   ///< [-] of a candidate's energy, by a form
inline constexpr double kLawLeaves = 0.25;  ///< [-] of a candidate's rest, by a drawn law instead

inline constexpr double kNoisyReading = 5;  ///< [-] deviations of the noise, in the largest reading
inline constexpr double kReadRange = 0.98;  ///< [-] of the largest reading: a saturation above it
inline constexpr double kOnBound = 1e-3;    ///< [-] of the scale of a size: it lies on the bound

// ---- Confidence in a name
inline constexpr double kMostSure = 0.97;  ///< [-] of coarse steps and the transfer system

// ---- Intervals of parameters
inline constexpr double kLargestInflation = 1e6;  ///< [-] of a variance, by other parameters
inline constexpr std::size_t kBiasDraws = 4;      ///< [draws] of the noise in the motion
inline constexpr double kLargestMove = 0.1;       ///< [scales] of a parameter, still linear
inline constexpr double kClusterBlock = 1.5;      ///< [s] of the residual, which correlates within,
inline constexpr Index kLeastCluster = 8;         ///< [rows] and at least so many rows

// ---- Proof
inline constexpr Index kLags = 20;            ///< [lags] of the residual's correlation
inline constexpr double kChiSquare99 = 37.6;  ///< [-] quantile of as many degrees of freedom
inline constexpr double kAllowance = 3;       ///< [-] on it: the colour of the noise is an estimate
inline constexpr double kWellAbove = 1.25;    ///< [-] the noise, as an error and as a variance
inline constexpr double kFarAbove =
    4;  ///< [-] the noise, as a variance alone: its size varies in time

// ---- Remainder and unknown
inline constexpr double kExplained = 0.85;  ///< [-] of the systematic residual: the rest remains
inline constexpr double kMostly = 0.5;      ///< [-] of it: the least beside an unknown rest
inline constexpr double kHasForm = 0.3;     ///< [-] of the remainder: it has this form
inline constexpr double kCommonLaw = 0.95;  ///< [-] of the energy of several terms, by one curve
inline constexpr double kPlain = 0.5;       ///< [-] variance beyond the noise, in all records
inline constexpr double kPlainEvent = 1;    ///< [-] the same, in one of them

// ---- Place of the excess
inline constexpr double kPlaceShare = 0.8;  ///< [-] of the excess, in the smallest set of cells

// ---- Form of an unknown effect
inline constexpr double kLeastExcess = 0.05;  ///< [-] over the noise: less may be its error
/// [-] ridge on the values of a form, over the mean square of its columns: free of units
inline constexpr double kRidge = 1e-3;
/// [-] of the value at a knot that comes from records, not from the ridge: the knot is visited
inline constexpr double kVisited = 0.95;
inline constexpr double kLeastShareOfForm = 0.12;  ///< [-] of the residual: any data have less
inline constexpr double kPriceOfSurface = 0.1;     ///< [-] it contains every curve of its arguments
inline constexpr double kSteadyShare = 0.05;  ///< [-] of its size: a state that varies less is held
inline constexpr double kBentSpeed = 0.05;    ///< [-] of the largest: the axis is linear below it
inline constexpr double kTurningSpeed = 0.01;   ///< [-] of the largest: friction turns within it
inline constexpr double kPresliding = 0.01;     ///< [-] of the largest displacement, before sliding
inline constexpr std::size_t kFittedForms = 4;  ///< [-] after screening
inline constexpr std::size_t kStartsOfForm = 4;  ///< [-]
inline constexpr double kLeastPeriods = 8;       ///< [periods] of a lasting sine, in a record
// Samples that a channel holds
inline constexpr double kLongestHold = 0.02;  ///< [-] of the record
inline constexpr Index kShortestHold = 2;     ///< [rows]
inline constexpr Index kMostHoldRows = 1000;  ///< [rows] a longer hold is several
inline constexpr Index kHoldEdge = 2;         ///< [rows] that a filter smears
inline constexpr double kMostHeld = 0.25;     ///< [-] of the record: samples are lost now and then
inline constexpr double kMostScatter = 9;     ///< [-] in a hold, over the noise: 3 deviations

}  // namespace rths::diagnosis

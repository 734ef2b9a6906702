#pragma once
// The figures of the report, each from what was read. DEM: symbols, law: solid lines, published (Imole et al. 2013):
// dashed lines. Curves are equations of model/ at the parameters of the files; nothing is fitted or integrated here.

#include "app/report/figure.hpp"
#include "chain/report_input.hpp"

namespace grainlaw::app::report {

/// P*, C*, phi_r against nu: isotropic unloading, steady shear, Eqs. (11), (12), (14).
Figure density_figure(const chain::ReportInput& input);
/// Eq. (15), Eq. (13) and F_v = g3 nu C on isotropic unloading.
Figure scaled_density_figure(const chain::ReportInput& input);

/// Figs. 1, 4 to 8 and 10 of the paper: every run that they show, ISO, UNI and D2 from both branches.
Figure modes_figure(const chain::ReportInput& input);

/// s_par against eps_dev, a panel per mode and density, with the recommended rung along the same path.
Figure stress_ratio_figure(const chain::ReportInput& input);
/// F_par likewise.
Figure fabric_figure(const chain::ReportInput& input);
/// P* over that of ISO unloading likewise.
Figure sheared_pressure_figure(const chain::ReportInput& input);

/// s_max, beta_s, F_max, beta_F against nu with Eq. (20).
Figure shear_law_figure(const chain::ReportInput& input);

/// Misfit of P*, s_par, F_par per calibration test of the coupled fit.
Figure residual_figure(const chain::ReportInput& input);

/// P* (over that of ISO unloading at the same density where it has one), s_par, F_par against eps_dev (where the path turns or does not
/// shear all along, its length; where it nowhere shears, nu) of one prediction by the recommended rung with its bands, others behind
/// toggles, and of the DEM runs of its path, those of another prediction of the same path by another engine, too; below, the residual
/// in units of the band.
Figure prediction_figure(const chain::ReportInput& input, std::size_t index);
std::string prediction_id(std::size_t index);  ///< of that figure

/// E_kin/E_pot, |energy residual|, inertial number against nu on the isotropic branches.
Figure preparation_quality_figure(const chain::ReportInput& input);
/// The same over the course of the element tests.
Figure shear_quality_figure(const chain::ReportInput& input);

/// A packing before and after shear, and the directions of its contacts and forces.
Drawing packing_drawing(const dem::ShearPictures& pictures);

}  // namespace grainlaw::app::report

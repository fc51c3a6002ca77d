//! The programs that parameters are written for: one entry each. Conventions are those of their sources, as
//! `docs/guide/export.md` cites them.

use super::form::{FlickerForm, Places};
use super::formats;
use super::kalman;
use super::quantity as q;
pub use super::target::Target;

/// White noise and a random walk.
const WHITE_AND_WALK: Places = Places { white: true, random_walk: true, flicker: FlickerForm::LeftOut };
/// White noise and one Gauss-Markov process.
const WHITE_AND_PROCESS: Places =
    Places { white: true, random_walk: false, flicker: FlickerForm::OneProcess };

/// Every target, in the order of the help.
pub const TARGETS: &[Target] = &[
    Target {
        id: "kalibr",
        convention: "export.convention.kalibr",
        comment: "#",
        places: WHITE_AND_WALK,
        step_s: None,
        quantities: &[
            q::density("gyroscope_noise_density"),
            q::walk_density("gyroscope_random_walk"),
            q::step_rate("update_rate"),
        ],
        write: formats::scalars,
    },
    Target {
        id: "imu_utils",
        convention: "export.convention.imu_utils",
        comment: "#",
        places: Places { white: true, random_walk: false, flicker: FlickerForm::Exact },
        step_s: None,
        quantities: &[q::deviation_at_one_second("gyr_n"), q::smallest_allan_deviation("gyr_w")],
        write: formats::axes_and_mean,
    },
    Target {
        id: "gnss-ins-sim",
        convention: "export.convention.gnss_ins_sim",
        comment: "#",
        places: WHITE_AND_PROCESS,
        step_s: None,
        quantities: &[
            q::bias_deg_h("gyro_b"),
            q::angle_random_walk("gyro_arw"),
            q::process_of_step("gyro_b_stability"),
            q::correlation_time("gyro_b_corr"),
        ],
        write: formats::python,
    },
    Target {
        id: "navego",
        convention: "export.convention.navego",
        comment: "%",
        places: Places { white: true, random_walk: true, flicker: FlickerForm::OneProcess },
        step_s: None,
        quantities: &[
            q::angle_random_walk("arw"),
            q::walk_of_step("arrw"),
            q::bias_deg_s("gb_sta"),
            q::process_deviation("gb_dyn"),
            q::correlation_time("gb_corr"),
            q::step_rate("freq"),
        ],
        write: formats::navego,
    },
    Target {
        id: "gazebo",
        convention: "export.convention.gazebo",
        comment: "",
        places: WHITE_AND_PROCESS,
        step_s: None,
        quantities: &[
            q::deviation_of_step("stddev"),
            q::process_density("dynamic_bias_stddev"),
            q::correlation_time("dynamic_bias_correlation_time"),
        ],
        write: formats::sdf,
    },
    Target {
        id: "px4",
        convention: "export.convention.px4",
        comment: "#",
        places: WHITE_AND_WALK,
        step_s: Some(0.010),
        quantities: &[
            q::deviation_of_step("EKF2_GYR_NOISE"),
            q::walk_of_step("EKF2_GYR_B_NOISE"),
            q::temperature_sensitivity("TC_G0_X1_#"),
        ],
        write: formats::px4,
    },
    Target {
        id: "ardupilot",
        convention: "export.convention.ardupilot",
        comment: "#",
        places: WHITE_AND_WALK,
        step_s: Some(0.012),
        quantities: &[
            q::deviation_of_step("EK3_GYRO_P_NSE"),
            q::walk_of_step("EK3_GBIAS_P_NSE"),
            q::scaled_temperature_sensitivity("INS_TCAL1_GYR1_#"),
        ],
        write: formats::ardupilot,
    },
    Target {
        id: "matlab",
        convention: "export.convention.matlab",
        comment: "%",
        places: Places { white: true, random_walk: true, flicker: FlickerForm::Exact },
        step_s: None,
        quantities: &[
            q::density("NoiseDensity"),
            q::flicker("BiasInstability"),
            q::walk_density("RandomWalk"),
            q::bias_rad_s("ConstantBias"),
            q::temperature_sensitivity("TemperatureBias"),
            q::scale_factor_temperature("TemperatureScaleFactor"),
        ],
        write: formats::gyroparams,
    },
    Target {
        id: "kalman",
        convention: "export.convention.kalman",
        comment: "",
        places: Places { white: true, random_walk: true, flicker: FlickerForm::Chain },
        step_s: None,
        quantities: &[
            q::density("white_noise_density"),
            q::walk_density("random_walk_density"),
            q::flicker("flicker_coefficient"),
            q::step_rate("rate"),
        ],
        write: kalman::write,
    },
];

/// The target of a name.
pub fn find(id: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|t| t.id == id)
}

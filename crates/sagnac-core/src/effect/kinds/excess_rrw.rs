//! Rate random walk that differs from the claimed one.

use crate::effect::{Both, Doc, Param};

pub struct ExcessRrw;

static DOC: Doc = Doc {
    title: Both {
        en: "rate random walk other than claimed",
        ru: "случайное блуждание скорости не по модели",
    },
    mechanism: Both {
        en: "Small independent shifts of the bias add up, with no preferred sign, faster or slower than the simulation has it.",
        ru: "Малые независимые сдвиги нуля накапливаются без преимущественного знака, быстрее или медленнее, чем в модели.",
    },
    formula: Both::same("S(f) = K²/(2πf)²"),
    signature: Both {
        en: "The spectrum rises as f⁻² towards low frequencies; the Allan deviation as τ to the power 1/2.",
        ru: "Спектр растёт как f⁻² к низким частотам, девиация Аллана — как τ в степени 1/2.",
    },
    told_by: Both {
        en: "A smooth driver falls as f⁻⁴ above its corner and leaves no roughness; a Markov process levels off; a step happens at one instant.",
        ru: "Плавное воздействие спадает как f⁻⁴ и не оставляет шероховатости; марковский процесс выходит на полку; скачок происходит в один момент.",
    },
    confirm: Both {
        en: "A longer record and a second one: the drift of a random walk takes another course each time.",
        ru: "Более длинная и повторная записи: ход случайного блуждания каждый раз иной.",
    },
    source: "IEEE Std 952, Annex C: rate random walk",
};

static PARAMS: [Param; 1] = [Param::reported("K_deg_h_rt_h", "deg/h/√h", 0.0, 1e4)];

describe! {
    ExcessRrw, "excess_rrw", Spectrum in Frequency, needs [],
    confusers ["unobserved_driver", "markov_long", "excess_flicker", "bias_step"]
}

frees! { ExcessRrw, RateRandomWalk, k, course true }

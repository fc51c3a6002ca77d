//! Flicker noise that differs from the claimed one.

use crate::effect::{Both, Doc, Param};

pub struct ExcessFlicker;

static DOC: Doc = Doc {
    title: Both {
        en: "flicker noise other than claimed", ru: "фликкер-шум не по модели"
    },
    mechanism: Both {
        en: "Electronics, the source's intensity and polarisation wander on all time scales at once, stronger or weaker than the simulation has it.",
        ru: "Электроника, интенсивность источника и поляризация блуждают на всех временах сразу, сильнее или слабее, чем в модели.",
    },
    formula: Both::same("S(f) = B²/(2πf)"),
    signature: Both {
        en: "An excess of the spectrum that rises as 1/f towards low frequencies; the flat floor of the Allan deviation at another height, 0.664 B.",
        ru: "Превышение спектра, растущее как 1/f к низким частотам; полка девиации Аллана на другой высоте, 0,664 B.",
    },
    told_by: Both {
        en: "A long Markov process makes a hump of the Allan deviation and not a floor over a decade; a random walk rises twice as steeply.",
        ru: "Длинный марковский процесс даёт горб девиации Аллана, а не полку шириной в декаду; случайное блуждание растёт вдвое круче.",
    },
    confirm: Both {
        en: "A longer record: the floor has to stay flat over two decades of τ.",
        ru: "Более длинная запись: полка должна оставаться ровной на двух декадах τ.",
    },
    source: "IEEE Std 952, Annex C: bias instability",
};

static PARAMS: [Param; 1] = [Param::reported("B_deg_h", "deg/h", 0.0, 1e4)];

describe! {
    ExcessFlicker, "excess_flicker", Spectrum in Frequency, needs [],
    confusers ["markov_long", "excess_rrw", "unobserved_driver"]
}

frees! { ExcessFlicker, Flicker, b, course false }

//! Angle random walk that differs from the claimed one.

use crate::effect::{Both, Doc, Param};

pub struct ExcessArw;

static DOC: Doc = Doc {
    title: Both {
        en: "angle random walk other than claimed", ru: "случайное блуждание угла не по модели"
    },
    mechanism: Both {
        en: "Shot noise, excess noise of the source, thermal noise of the receiver: white noise of the rate, stronger or weaker than the simulation has it.",
        ru: "Дробовой шум, избыточный шум источника, тепловой шум приёмника: белый шум скорости, сильнее или слабее, чем в модели.",
    },
    formula: Both::same("S(f) = 3600 N²"),
    signature: Both {
        en: "A flat excess of the spectrum up to the Nyquist frequency; the Allan deviation keeps its slope of −1/2 at another height.",
        ru: "Плоское превышение спектра до частоты Найквиста; девиация Аллана сохраняет наклон −1/2 на другой высоте.",
    },
    told_by: Both {
        en: "A short Markov process and a filter leave the flat shape near the Nyquist frequency; outliers and a changing level are not the same over time.",
        ru: "Короткий марковский процесс и фильтр меняют плоскую форму у частоты Найквиста; выбросы и меняющийся уровень неодинаковы во времени.",
    },
    confirm: Both {
        en: "Record at another optical power: shot noise and source noise scale differently with it.",
        ru: "Записать при другой оптической мощности: дробовой шум и шум источника зависят от неё по-разному.",
    },
    source: "IEEE Std 952, Annex C",
};

static PARAMS: [Param; 1] = [Param::reported("N_deg_rt_h", "deg/√h", 0.0, 1e3)];

describe! {
    ExcessArw, "excess_arw", Spectrum in Frequency, needs [],
    confusers ["markov_short", "noise_variance_time", "outlier_bursts"]
}

frees! { ExcessArw, AngleRandomWalk, n, course false }

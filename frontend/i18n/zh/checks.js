// The checks of the observers' theorems in Chinese: names and findings (backend/thetascope/engine/observers), and why an observer diverged.

const NUMBER = '(-?[\\d.]+(?:e[-+]?\\d+)?)';
/** @param {string} text @param {string} made @returns {[RegExp, string]} */
const rule = (text, made) => [new RegExp(`^${text.replaceAll('#', NUMBER)}$`), made];

export const checkNames = {
  'canonical form': '规范型',
  'uniform observability': '一致可观性',
  'f globally Lipschitz': 'f 全局 Lipschitz',
  'persistent excitation': '持续激励',
  observability: '可观性',
  'matching condition': '匹配条件',
  'Lyapunov inequality': 'Lyapunov 不等式',
  'chain of integrators': '积分链',
  'γ one-sided Lipschitz': 'γ 单边 Lipschitz',
  'vector relative degree': '向量相对阶',
  'decoupling matrix nonsingular': '解耦矩阵非奇异',
  'α and F Lipschitz': 'α 和 F Lipschitz',
  'no hysteresis': '无迟滞',
  'every operator reaches its linear zones': '每个算子都到达线性区',
  'innovations consistent with P and R': '新息与 P、R 一致',
  'L1 → hysteresis → L2': 'L1 → 迟滞 → L2',
  'inequality (6) as printed': '原文印刷的不等式 (6)',
  'observability of (A, C)': '(A, C) 的可观性',
  'observability of (x, θ)': '(x, θ) 的可观性',
  'observable with an operator active': '有算子活动时可观',
};

/** @type {import('./translator.js').Rule[]} */
export const checkRules = [
  rule('Gamma positive definite', 'Γ 正定'),
  rule('(.+) positive definite', '$1 正定'),
  rule('(.+) stable', '$1 稳定'),
  rule('(.+) inside the unit circle', '$1 在单位圆内'),
  rule('rho ≥ #', 'ρ ≥ $1'),

  rule('the plant is in the form \\(3\\): z = (.+)', '对象已具有形式 (3)：z = $1'),
  rule('the plant is brought to the form \\(3\\): z = (.+)', '对象被化为形式 (3)：z = $1'),
  rule(
    'the inputs enter triangularly \\(checked at points near the initial state\\)',
    '输入以三角形式进入（在初始状态附近的点上检验）',
  ),
  rule(
    'an input enters a canonical equation through a later state, so some input may hide a state',
    '有输入经由后面的状态进入规范型方程，因此某些输入可能掩盖状态',
  ),
  rule('eigenvalues (.+); largest real part #', '特征值 $1；最大实部 $2'),
  rule('eigenvalues (.+); largest modulus #', '特征值 $1；最大模 $2'),
  rule('f is affine in the states', 'f 关于状态是仿射的'),
  rule(
    'f is not affine; the model is saturated .+',
    'f 不是仿射的；模型限制在对象的定义域内，若定义域有界，则其中为 Lipschitz',
  ),
  rule('rho = #; the bound on Υ does not depend on ρ from 1 on', 'ρ = $1；自 1 起 Υ 的界与 ρ 无关'),
  rule('the run is shorter than the window of # s', '运行时间短于窗口 $1 s'),
  rule('the run is shorter than the window, or not finite', '运行时间短于窗口，或数值无穷'),
  rule(
    'smallest eigenvalue of the Gramian of Ω over # s: #, asked for #',
    'Ω 的 Gram 矩阵在 $1 s 内的最小特征值：$2，要求 $3',
  ),
  rule(
    'smallest eigenvalue of ∫ΩᵀR⁻¹Ω dt over # s, in typical faults: #, asked for #',
    '∫ΩᵀR⁻¹Ω dt 在 $1 s 内的最小特征值，以典型故障计：$2，要求 $3',
  ),
  rule(
    'smallest eigenvalue of the Gramian of \\(x, θ\\) over # s, in scaled units and weighted by R: # to # along the run, asked for #',
    '(x, θ) 的 Gram 矩阵在 $1 s 内的最小特征值，按比例缩放并以 R 加权：沿运行 $2 至 $3，要求 $4',
  ),
  rule('smallest eigenvalue over the run: #', '运行中的最小特征值：$1'),
  rule('conditions of the theorem', '定理的条件'),
  rule('the numbers left the range in which they can be judged', '数值超出可判断的范围'),
  rule('K = P Cᵀ R⁻¹ did not stay finite: raise r, or lower q', 'K = P Cᵀ R⁻¹ 趋于无穷：请增大 r 或减小 q'),
  rule('no finite (?:value|estimate|innovation) was recorded', '没有记录到有限的数值'),
  rule('there is nothing to estimate', '没有需要估计的量'),
  rule(
    'smallest singular value of the observability matrix, relative to the largest: # to # along the run \\(frozen, in scaled states\\)',
    '可观性矩阵最小与最大奇异值之比：沿运行 $1 至 $2（冻结时刻，状态已缩放）',
  ),
  rule(
    'largest real part of the eigenvalues, frozen at # instants: at most #',
    '在 $1 个时刻冻结，特征值的最大实部：至多 $2',
  ),
  rule(
    'largest modulus of the eigenvalues, frozen at # instants: at most #',
    '在 $1 个时刻冻结，特征值的最大模：至多 $2',
  ),
  rule(
    'mean of (.+) over the second half of the run: #; it is 1 where q, q_theta and r fit, and up to 2 is taken as fitting',
    '$1 在后半段运行的均值：$2；q、q_theta、r 合适时为 1，至多 2 视为合适',
  ),
  rule(
    'mean of (.+) over the second half of the run: #; it is 1 where q, q_theta and r fit: there is less noise than the filter was told of',
    '$1 在后半段运行的均值：$2；q、q_theta、r 合适时为 1：噪声比告知滤波器的小',
  ),
  rule('a plant of more than # states is not looked at \\(it has #\\)', '状态多于 $1 个的对象不作检验（现有 $2 个）'),
  rule(
    '# of # operators rise and fall in their linear zones in the second half of the run',
    '后半段运行中 $2 个算子里有 $1 个在线性区内上升和下降',
  ),
  rule(
    '# of # operators rise and fall in their linear zones in the second half of the run; (.+) did not, so a wrong memory may stay wrong for good: drive the plant harder',
    '后半段运行中 $2 个算子里有 $1 个在线性区内上升和下降；第 $3 个没有，错误的记忆可能一直错下去：请加大激励',
  ),
  rule(
    'α = #, n = #: exponents (.+) in \\(11\\); the example as printed has 2α − 1 in all lines',
    'α = $1，n = $2：(11) 中的指数为 $3；原文例子各行均为 2α − 1',
  ),
  rule('α = #, n = #: exponents (.+)', 'α = $1，n = $2：指数 $3'),
  rule('there is no P of the matching condition to hold it against', '没有满足匹配条件的 P 可供比较'),
  rule(
    '(\\(A − KC\\)ᵀP \\+ P\\(A − KC\\)) < −c P holds up to c = #; the print asks for c > 2 c2 \\+ 1 = # with c2 ≥ k1 √n.+',
    '$1 < −c P 在 c 至 $2 时成立；原文要求 c > 2 c2 + 1 = $3，其中 c2 ≥ k1 √n，但任何 K 都有 c ≤ 2 k1/n（证明中的界丢了因子 ρ）：它对本次运行什么也证明不了',
  ),
  rule("every state's equation contains the next state with coefficient 1", '每个状态的方程都以系数 1 含有下一个状态'),
  rule(
    "some state's equation does not contain the next state; γ = f − A x makes up for it",
    '有的状态方程不含下一个状态；由 γ = f − A x 弥补',
  ),
  rule('no constant P has P Φ = Cᵀgᵀ: (.+)', '没有常数 P 使 P Φ = Cᵀgᵀ：$1'),
  rule('the column of (\\S+) changes its direction with (.+)', '$1 的列随 $2 改变方向'),
  rule('the columns of (\\S+) and (\\S+) point along different vectors', '$1 和 $2 的列方向不同'),
  rule(
    'Φ = d·\\(CΦ\\), but no P was found to go with it \\(see the inequality\\)',
    'Φ = d·(CΦ)，但没有找到与之相配的 P（见不等式）',
  ),
  rule(
    'P = (.+), g = \\(CΦ\\)ᵀ: largest \\|PΦ − Cᵀgᵀ\\| over the run #',
    'P = $1，g = (CΦ)ᵀ：运行中最大的 |PΦ − Cᵀgᵀ| 为 $2',
  ),
  rule(
    'no P > 0 with P d = Cᵀ satisfies (.+) < 0: (.+) is not strictly positive real; its zeros are (.+); (no K helps|another K may do)',
    '没有 P > 0 在 P d = Cᵀ 下满足 $1 < 0：$2 不是严格正实的；其零点为 $3；$4',
  ),
  rule('no K helps', '任何 K 都无济于事'),
  rule('another K may do', '换一个 K 或许可以'),
  rule(
    'largest eigenvalue of (\\(A − KC\\)ᵀP \\+ P\\(A − KC\\)): #; smallest of P: #',
    '$1 的最大特征值：$2；P 的最小特征值：$3',
  ),
  rule('β1 ≥ # along the estimates of this run', '沿本次运行的估计 β1 ≥ $1'),
  rule('γ is affine in the state, so the bound is global', 'γ 关于状态是仿射的，故该界是全局的'),
  rule('γ is not affine, and whether a bound holds everywhere is not decided', 'γ 不是仿射的，是否处处有界未作判断'),
  rule('largest gain on a state of L1: #', 'L1 状态上的最大增益：$1'),
  rule("the output is L2's", '输出属于 L2'),
  rule('the output depends on L1', '输出依赖于 L1'),
  rule(
    'they are not linear: the numbers below are those at the last estimate',
    '它们不是线性的：下面的数值取自最后的估计',
  ),
  rule('(L\\d): none', '$1：无'),
  rule('(L\\d): none, it feeds back to L1', '$1：无，它反馈到 L1'),
  rule('(L\\d): ([^;]+)', '$1：$2'),
  rule(
    'rank # of # with any operator in a linear zone, # with none: while all operators hold, L1 cannot be seen',
    '任一算子在线性区时秩为 $1（共 $2），没有时为 $3：所有算子都保持时看不到 L1',
  ),
  rule(
    'rank # of # with any operator in a linear zone, # with none',
    '任一算子在线性区时秩为 $1（共 $2），没有时为 $3',
  ),
  rule(
    'the plant has # backlash operators; this observer takes each for its slope',
    '对象有 $1 个间隙算子；该观测器把每个都当作其斜率',
  ),
  rule('(\\([\\d, ]+\\)), which sums to n = #; (.+)', '$1，其和为 n = $2；$3'),
  rule(
    '# outputs and # inputs: it is not square; the observer does not need it',
    '$1 个输出和 $2 个输入：不是方阵；该观测器不需要它',
  ),
  rule('smallest \\|det F\\| along the estimates of this run: #', '沿本次运行的估计，最小的 |det F|：$1'),
  rule('they are affine in the state', '它们关于状态是仿射的'),
  rule(
    'they are not affine in the state: locally at most, .+',
    '它们关于状态不是仿射的：至多局部成立，未求其界；收敛是局部的，增益或初始估计相差太远可能永不收敛',
  ),

  rule(
    'Γ grew without bound: excitation was lost while λ kept forgetting; lower λ or excite the plant',
    'Γ 无界增长：失去激励而 λ 继续遗忘；请降低 λ 或激励对象',
  ),
  rule(
    'the parameter covariance grew without bound: excitation was lost; lower λ or excite the plant',
    '参数协方差无界增长：失去激励；请降低 λ 或激励对象',
  ),
  rule(
    'the Riccati equation lost definiteness; raise r or lower q, or take a shorter step',
    'Riccati 方程失去正定性；请增大 r、减小 q 或缩短步长',
  ),
  rule('Υ grew without bound: A − KC is not stable along this run', 'Υ 无界增长：A − KC 沿本次运行不稳定'),
  rule(
    'x̂ left every bound: the initial estimate is outside the region of convergence, or the gain is too low',
    'x̂ 超出一切界限：初始估计在收敛域之外，或增益太低',
  ),
  rule('θ̂ left every bound: lower λ or the initial Γ', 'θ̂ 超出一切界限：请降低 λ 或初始 Γ'),
  rule('the state (\\S+) left every bound', '状态 $1 超出一切界限'),
  rule("the plant's own state escapes to infinity", '对象自身的状态趋于无穷'),
];

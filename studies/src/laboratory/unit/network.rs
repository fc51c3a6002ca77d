//! Heat that flows between nodes of a network, integrated in time.

/// A connection of two nodes, or of a node to its surroundings.
#[derive(Debug, Clone, Copy)]
struct Link {
    from: usize,
    to: Option<usize>,
    w_per_k: f64,
}

/// Nodes with heat capacities and their connections.
#[derive(Debug, Clone, Default)]
pub struct Network {
    capacity_j_per_k: Vec<f64>,
    links: Vec<Link>,
}

impl Network {
    /// Adds a node and gives its number.
    pub fn node(&mut self, capacity_j_per_k: f64) -> usize {
        self.capacity_j_per_k.push(capacity_j_per_k);
        self.capacity_j_per_k.len() - 1
    }

    /// Connects two nodes.
    pub fn connect(&mut self, from: usize, to: usize, w_per_k: f64) {
        self.links.push(Link { from, to: Some(to), w_per_k });
    }

    /// Connects a node to the surroundings.
    pub fn expose(&mut self, node: usize, w_per_k: f64) {
        self.links.push(Link { from: node, to: None, w_per_k });
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.capacity_j_per_k.len()
    }

    /// Whether it has no node.
    pub fn is_empty(&self) -> bool {
        self.capacity_j_per_k.is_empty()
    }

    /// Heat of all nodes over 0 °C, J.
    pub fn heat_j(&self, deg_c: &[f64]) -> f64 {
        self.capacity_j_per_k.iter().zip(deg_c).map(|(c, t)| c * t).sum()
    }

    /// Temperatures over time in surroundings given at each step, with power in W put into each node. The step is divided
    /// so that the fastest node keeps less than a third of its difference away.
    pub fn run(
        &self,
        start_deg_c: &[f64],
        around_deg_c: &[f64],
        power_w: &[f64],
        step_s: f64,
    ) -> Vec<Vec<f64>> {
        let mut load = vec![0.0; self.len()];
        for link in &self.links {
            load[link.from] += link.w_per_k;
            if let Some(to) = link.to {
                load[to] += link.w_per_k;
            }
        }
        let fastest = load.iter().zip(&self.capacity_j_per_k).map(|(l, c)| l / c).fold(0.0, f64::max);
        let parts = (step_s * fastest * 3.0).ceil().max(1.0) as usize;
        let fine_s = step_s / parts as f64;
        let mut now = start_deg_c.to_vec();
        let mut courses = vec![Vec::with_capacity(around_deg_c.len()); self.len()];
        let mut flow = vec![0.0; self.len()];
        for around in around_deg_c {
            courses.iter_mut().zip(&now).for_each(|(c, t)| c.push(*t));
            for _ in 0..parts {
                flow.copy_from_slice(power_w);
                for link in &self.links {
                    let other = link.to.map_or(*around, |to| now[to]);
                    let heat = link.w_per_k * (other - now[link.from]);
                    flow[link.from] += heat;
                    if let Some(to) = link.to {
                        flow[to] -= heat;
                    }
                }
                for (t, (f, c)) in now.iter_mut().zip(flow.iter().zip(&self.capacity_j_per_k)) {
                    *t += fine_s * f / c;
                }
            }
        }
        courses
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_node_relaxes_as_its_closed_form() {
        let mut network = Network::default();
        let node = network.node(100.0);
        network.expose(node, 0.5);
        // Time constant 200 s; 2 W hold it 4 °C above its surroundings.
        let course = network.run(&[50.0], &vec![20.0; 1001], &[2.0], 1.0);
        for t in [0usize, 100, 400, 1000] {
            let closed = 24.0 + 26.0 * (-(t as f64) / 200.0).exp();
            assert!((course[node][t] - closed).abs() < 0.03, "{t}: {} {closed}", course[node][t]);
        }
    }

    #[test]
    fn nothing_is_lost_between_nodes_without_surroundings() {
        let mut network = Network::default();
        let nodes: Vec<usize> = (0..5).map(|i| network.node(10.0 + i as f64)).collect();
        nodes.windows(2).for_each(|w| network.connect(w[0], w[1], 0.3));
        let start = [10.0, 40.0, -5.0, 22.0, 60.0];
        let courses = network.run(&start, &vec![0.0; 5000], &[0.0; 5], 1.0);
        let last: Vec<f64> = courses.iter().map(|c| c[4999]).collect();
        assert!((network.heat_j(&last) - network.heat_j(&start)).abs() < 1e-6);
        let mean = network.heat_j(&start) / network.heat_j(&[1.0; 5]);
        assert!(last.iter().all(|t| (t - mean).abs() < 0.01), "{last:?} {mean}");
    }
}
